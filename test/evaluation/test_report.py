# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import base64
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest
from synthetic_run import synthetic_run

from msss_graphslam.evaluation.assessment import assess
from msss_graphslam.evaluation.report import write_comparison_report, write_report
from msss_graphslam.results.directory import ResultDirectory


class Page(HTMLParser):
    """The images, links and words of a page, and whether its tags are closed."""

    VOID = frozenset({"meta", "img", "br", "link", "input", "hr"})

    def __init__(self, text):
        super().__init__()
        self.images, self.references, self.open, self.words = [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        if tag == "img":
            self.images.append(attributes["src"])
        self.references += [
            value for name, value in attrs if name in ("href", "src", "action", "srcset")
        ]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if not self.open or self.open[-1] not in ("style", "script"):
            self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    path = tmp_path_factory.mktemp("run")
    write_report(ResultDirectory.create(path), assess(synthetic_run(6)))
    return path


@pytest.fixture(scope="module")
def page(written):
    return Page((written / "report.html").read_text())


def report_of(record, path):
    write_report(ResultDirectory.create(path), assess(record))
    return Page((path / "report.html").read_text())


def test_the_report_needs_nothing_else(page, written):
    assert all(reference.startswith("data:image/png;base64,") for reference in page.references)
    text = (written / "report.html").read_text()
    assert not re.search(r"https?://|url\(|@import|<script|<link", text)
    assert page.open == []


def test_every_figure_is_in_the_report_and_in_the_directory(page, written):
    embedded = {base64.b64decode(image.partition(",")[2]) for image in page.images}
    stored = {path.read_bytes() for path in (written / "figures").glob("*.png")}
    assert embedded == stored
    assert len(stored) == 9
    assert all(image.startswith(b"\x89PNG") for image in stored)


def test_the_report_says_what_a_reader_looks_for(page):
    for words in (
        "Graph SLAM of pond.mcap",
        "mean position error",
        "No /dvl/twist: the forward speed is assumed.",
        "beam without bins",
        "scan matching",
        "segmentation.echo_contrast",
        "msss run pond.mcap --out out",
        "msss_graphslam 0.1.0",
        "2023-11-14 22:13:20 UTC",
    ):
        assert words in page.text


def test_without_truth_the_report_has_no_error(tmp_path):
    page = report_of(synthetic_run(4, with_truth=False), tmp_path)
    assert "no ground truth, so no errors are given" in page.text
    for words in ("mean error", "RMSE", "mean aligned", "position error", "anchored", "band"):
        assert words not in page.text


def test_changed_parameters_are_counted_and_marked(tmp_path):
    record = synthetic_run(3)
    mapping = {**record.configuration["mapping"], "resolution": 0.37}
    record = replace(record, configuration={**record.configuration, "mapping": mapping})
    text = report_of(record, tmp_path).text
    assert "1 of them changed from their defaults" in text
    assert "0.37" in text


def test_names_cannot_break_out_of_the_page(tmp_path):
    record = synthetic_run(3)
    hostile = "<script>alert('x')</script>"
    bag = replace(record.bag, name=hostile, damage=("chunk 3 <b>lost",))
    page = report_of(replace(record, bag=bag), tmp_path)
    assert hostile in page.text
    assert "chunk 3 <b>lost" in page.text
    assert "<script" not in (tmp_path / "report.html").read_text()


def test_a_report_of_the_same_run_has_the_same_bytes(tmp_path):
    for name in ("one", "other"):
        report_of(synthetic_run(3), tmp_path / name)
    one, other = (tmp_path / name / "report.html" for name in ("one", "other"))
    assert one.read_bytes() == other.read_bytes()


def test_a_comparison_has_one_table_of_all_estimators(tmp_path):
    names = ("dead_reckoning", "uspic", "chen2015", "full")
    runs = [assess(synthetic_run(3, estimator=name)) for name in names]
    write_comparison_report(ResultDirectory.create(tmp_path), runs)
    page = Page((tmp_path / "report.html").read_text())
    for words in ("dead reckoning", "uspic, online", "chen2015, online", "full, online"):
        assert words in page.text
    assert len(page.images) == 3
