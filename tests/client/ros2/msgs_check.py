"""The .msg files of tactus_msgs, as the tools of ROS 2 itself read them (Debian's
rosidl-tools), against the types with which the peer of the tests was made.

    msgs_check.py client/ros2/tactus_msgs tests/tools/ros2/ros2_types.idl

Exits with 77 where the tools are absent.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import em  # noqa: F401  rosidl translates with it.
    from rosidl_parser import definition
    from rosidl_parser.parser import parse_idl_file
except ImportError as error:
    print(f"msgs_check: skipped, {error}: needs rosidl-tools and python3-empy")
    sys.exit(77)

NUMBERS = {"uint8": "octet", "uint32": "unsigned long", "int32": "long",
           "uint64": "unsigned long long"}


def name_of(kind):
    if isinstance(kind, definition.NamespacedType):
        return "::".join(kind.namespaces + ["dds_", kind.name + "_"])
    if isinstance(kind, definition.AbstractSequence):
        return f"sequence<{name_of(kind.value_type)}>"
    if isinstance(kind, definition.AbstractString):
        return "string"
    return NUMBERS.get(kind.typename, kind.typename)


package, peer = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).read_text()
names = sorted(path.stem for path in (package / "msg").glob("*.msg"))
assert names, package
wrong = 0
with tempfile.TemporaryDirectory() as folder:
    subprocess.run(["/usr/bin/python3", "/usr/bin/rosidl", "translate",
                    "--output-path", folder, "--from", "msg", "--to", "idl",
                    package.name, *(f"msg/{name}.msg" for name in names)],
                   cwd=package, check=True, stdout=subprocess.DEVNULL)
    for name in names:
        read = parse_idl_file(definition.IdlLocator(
            pathlib.Path(folder), pathlib.Path("msg") / f"{name}.idl"))
        (message,) = read.content.get_elements_of_type(definition.Message)
        want = [(name_of(member.type), member.name)
                for member in message.structure.members]
        body = re.search(r"module tactus_msgs .*struct " + name +
                         r"_ \{(.*?)\};", peer, re.S).group(1)
        got = [tuple(field.strip().rsplit(None, 1))
               for field in body.split(";") if field.strip()]
        print(f"{name}: {len(want)} fields")
        if want != got:
            print(f"{name}: the peer has {got}, ROS 2 reads {want}")
            wrong += 1
sys.exit(1 if wrong else 0)
