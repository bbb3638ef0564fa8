# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Build ``tf2_msgs`` where ROS comes from wheels, which lack it.

``python build_tf2_msgs.py PREFIX`` generates the message's code with the wheels' own generators,
compiles it and prints the environment in which a process finds it. Nothing is stubbed: the
libraries are those that rclpy loads of any other message.
"""

import json
import os
import subprocess
import sys
import sysconfig
from pathlib import Path

PACKAGE = "tf2_msgs"
MESSAGE = "TFMessage"
DEFINITION = "geometry_msgs/TransformStamped[] transforms\n"
FAST_RTPS = "rosidl_typesupport_fastrtps_c"
INTROSPECTION = "rosidl_typesupport_introspection_c"
"""The middleware serialises with the one and describes the type to others with the other."""
DEPENDENCIES = ["geometry_msgs", "std_msgs", "builtin_interfaces"]
COMPILERS = ("gcc", "g++")
"""The generated type supports are C++."""


def environment(prefix: Path) -> dict[str, str]:
    """Return the variables that a process needs: ours before what is set already."""
    before = {**os.environ, "AMENT_PREFIX_PATH": os.environ.get("AMENT_PREFIX_PATH", sys.prefix)}
    folders = {
        "PYTHONPATH": prefix / "python",
        "LD_LIBRARY_PATH": prefix / "lib",
        "AMENT_PREFIX_PATH": prefix,
    }
    return {
        name: os.pathsep.join([str(folder), *filter(None, [before.get(name)])])
        for name, folder in folders.items()
    }


def build(prefix: Path) -> None:
    """Leave under ``prefix`` what rclpy needs to publish and receive the message."""
    os.environ["AMENT_PREFIX_PATH"] = sys.prefix
    source = prefix / "source" / PACKAGE
    library = prefix / "lib"
    module = prefix / "python" / PACKAGE
    for folder in (source / "msg", library, module):
        folder.mkdir(parents=True, exist_ok=True)
    (source / "msg" / f"{MESSAGE}.msg").write_text(DEFINITION, encoding="utf-8")
    generate(source, module)
    compile_libraries(source, module, library)
    index = prefix / "share" / "ament_index" / "resource_index" / "packages"
    index.mkdir(parents=True, exist_ok=True)
    (index / PACKAGE).touch()


def generate(source: Path, module: Path) -> None:
    """Write the C and Python code of the message.

    The generators are called one by one: ``rosidl generate`` looks for them by entry points, and
    each wheel declares its own twice.
    """
    from rosidl_adapter.msg import convert_msg_to_idl
    from rosidl_generator_c.cli import GenerateC
    from rosidl_generator_py.cli import GeneratePython
    from rosidl_generator_type_description.cli import HashTypeDescription
    from rosidl_typesupport_c.cli import GenerateCTypesupport
    from rosidl_typesupport_fastrtps_c.cli import GenerateFastRTPSCTypesupport
    from rosidl_typesupport_introspection_c.cli import GenerateIntrospectionCTypesupport

    convert_msg_to_idl(source, PACKAGE, Path("msg", f"{MESSAGE}.msg"), source / "msg")
    share = [str(Path(sys.prefix, "share", name)) for name in DEPENDENCIES]
    task = (PACKAGE, [f"{source}:msg/{MESSAGE}.idl"], share)
    hashes = HashTypeDescription("description").generate_type_hashes(*task, source)
    GenerateC("c").generate(*task, source, hashes)
    GenerateFastRTPSCTypesupport("fastrtps_c").generate(*task, source)
    GenerateIntrospectionCTypesupport("introspection_c").generate(*task, source)
    dispatch = GenerateCTypesupport("c", typesupport_implementations=[FAST_RTPS, INTROSPECTION])
    dispatch.generate(*task, source)
    python = GeneratePython("py", typesupport_implementations=["rosidl_typesupport_c"])
    python.generate(*task, module)
    (module / "__init__.py").touch()


def compile_libraries(source: Path, module: Path, library: Path) -> None:
    """Compile and link what :func:`generate` wrote, each library upon those before it."""
    detail = source / "msg" / "detail"
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    introspection = detail / "tf_message__type_support.c"
    code = {
        library / f"lib{PACKAGE}__rosidl_generator_c.so": set(detail.glob("*.c"))
        - {introspection},
        library / f"lib{PACKAGE}__{INTROSPECTION}.so": [introspection],
        library / f"lib{PACKAGE}__{FAST_RTPS}.so": detail.glob("*.cpp"),
        library / f"lib{PACKAGE}__rosidl_typesupport_c.so": (source / "msg").glob("*.cpp"),
        library / f"lib{PACKAGE}__rosidl_generator_py.so": (module / "msg").glob("*.c"),
        module / f"{PACKAGE}_s__rosidl_typesupport_c{suffix}": module.glob("*.c"),
    }
    built: list[Path] = []
    for target, files in code.items():
        subprocess.run(command(target, sorted(files), built, source.parent), check=True)
        built.append(target)


def command(target: Path, code: list[Path], built: list[Path], source: Path) -> list[str]:
    """Return the compiler's command line for one library."""
    import numpy as np

    compiler = "gcc" if code[0].suffix == ".c" else "g++"
    include = Path(sys.prefix, "include")
    folders = [source, include, *(path for path in include.iterdir() if path.is_dir())]
    folders += [Path(sysconfig.get_path("include")), Path(np.get_include())]
    libraries = [
        path
        for name in ["rosidl_", "fastcdr", *(f"{name}__" for name in DEPENDENCIES)]
        for path in sorted(Path(sys.prefix, "lib").glob(f"lib{name}*.so"))
    ]
    options = ["-shared", "-fPIC", "-O1", "-w", f"-Wl,-soname,{target.name}"]
    options += ["-Wl,--as-needed", "-Wl,--allow-shlib-undefined"]
    inputs = [*code, *built, *libraries]
    return [
        *(compiler, *options, "-o", str(target)),
        *(f"-I{folder}" for folder in folders),
        *map(str, inputs),
    ]


if __name__ == "__main__":
    build(Path(sys.argv[1]).absolute())
    print(json.dumps(environment(Path(sys.argv[1]).absolute())))
