"""Executes examples/notebook/touch.ipynb in a new kernel, without and with a server, and
compares what its cells print and draw with the outputs in the file.

After a change of its cells, TACTUS_RECORD_NOTEBOOK=yes puts the outputs of the execution with
a server into the file:

  TACTUS_PYTHON_NATIVE=yes TACTUS_RECORD_NOTEBOOK=yes client/python/tests/run.sh \\
    build/release/bin notebook_test
"""

import json
import os
import pathlib
import re
import sys
import tempfile
import unittest
from unittest import mock

from support import ROOT, Server

try:
    from tactus import _native
except ImportError:
    _native = None

PATH = ROOT / "examples/notebook/touch.ipynb"
# A folder at the root of a machine, in neither an address nor a closing tag.
ABSOLUTE_PATH = r"(?<![\w<:/.])/\w+/"
ACCURACY = r"^accuracy (0\.\d{3}|1\.000), of each day: "
RECORD = os.environ.get("TACTUS_RECORD_NOTEBOOK") == "yes"


def execute(**environment):
    """The notebook with fresh outputs. The kernel is this Python, so that it has the wheel; it
    knows no settings of the user and no TACTUS_ variable but those given."""
    import nbformat
    from nbclient import NotebookClient

    with tempfile.TemporaryDirectory(prefix="tactus-notebook-") as name:
        folder = pathlib.Path(name)
        clean = {key: value for key, value in os.environ.items()
                 if not key.startswith("TACTUS_") and key not in ("PYTHONPATH", "MPLBACKEND")}
        clean.update(environment, IPYTHONDIR=f"{folder}/ipython", JUPYTER_PATH=name,
                     JUPYTER_RUNTIME_DIR=f"{folder}/run", JUPYTER_CONFIG_DIR=f"{folder}/config",
                     PYDEVD_DISABLE_FILE_VALIDATION="1")
        work = folder / "work"
        work.mkdir()
        kernel = folder / "kernels/this-python/kernel.json"
        kernel.parent.mkdir(parents=True)
        kernel.write_text(json.dumps({
            "argv": [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"],
            "display_name": "Python 3", "language": "python"}))
        notebook = nbformat.read(PATH, as_version=4)
        for cell in code_cells(notebook):
            cell.outputs, cell.execution_count = [], None
        with mock.patch.dict(os.environ, clean, clear=True):
            NotebookClient(notebook, kernel_name="this-python", timeout=300, record_timing=False,
                           resources={"metadata": {"path": str(work)}}).execute()
    notebook.metadata.language_info = {"name": "python"}
    return notebook


def code_cells(notebook):
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def printed(cell):
    """What a cell wrote to its standard output."""
    return "".join("".join(output["text"]) for output in cell["outputs"]
                   if output.get("name") == "stdout")


def html(cell):
    return ["".join(output["data"]["text/html"]) for output in cell["outputs"]
            if "text/html" in output.get("data", {})]


def structure(cell):
    """What kinds of output a cell has, in their order, and its text without numbers. Standard
    error is left out: libraries warn there of what this machine has."""
    return ([sorted(output["data"]) for output in cell["outputs"] if "data" in output],
            re.sub(r"\d+(\.\d*)?", "#", printed(cell)))


class FileTest(unittest.TestCase):
    """The file as it is committed."""

    def test_it_has_nothing_of_a_machine(self):
        text = PATH.read_text()
        self.assertLess(len(text), 200_000)
        notebook = json.loads(text)
        self.assertEqual((notebook["nbformat"], notebook["nbformat_minor"]), (4, 5))
        self.assertEqual(notebook["metadata"], {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"}})
        for cell in code_cells(notebook):
            outputs = [{**output, "data": {kind: value for kind, value in output.get(
                "data", {}).items() if kind != "image/png"}} for output in cell["outputs"]]
            lines = json.dumps(outputs).replace("\\n", "\n")
            self.assertNotRegex(lines, ABSOLUTE_PATH, cell["id"])
        for cell in notebook["cells"]:
            self.assertEqual(cell["metadata"], {}, cell["id"])

    def test_all_cells_were_executed_in_their_order(self):
        cells = code_cells(json.loads(PATH.read_text()))
        self.assertEqual([cell["execution_count"] for cell in cells],
                         list(range(1, len(cells) + 1)))
        for cell in cells:
            for output in cell["outputs"]:
                self.assertNotEqual(output["output_type"], "error", cell["id"])
                self.assertNotEqual(output.get("name"), "stderr", cell["id"])


@unittest.skipUnless(_native, "the notebook needs the compiled module: TACTUS_PYTHON_NATIVE=yes")
class ExecutionTest(unittest.TestCase):
    def check_without_server(self, cells):
        self.assertRegex(printed(cells["fit"]), r"classes: hard soft")
        (accuracy,) = re.findall(ACCURACY, printed(cells["validation"]))
        self.assertGreater(float(accuracy), 0.9)
        self.assertIn("contact 1 touched", printed(cells["stream"]))
        self.assertIn("contact 1 decided class: soft", printed(cells["stream"]))
        self.assertIn("best: soft", printed(cells["stream"]))
        stream, answer = html(cells["stream"])
        self.assertEqual(stream.count("<svg"), 1)
        self.assertIn("decided class: soft", stream)
        # The skin, the classes, the question and the line of time.
        self.assertEqual(answer.count("<svg"), 4)
        for name in ("hard", "soft"):
            self.assertIn(f">{name}</text>", answer)

    def test_without_server(self):
        cells = {cell["id"]: cell for cell in code_cells(execute())}
        self.check_without_server(cells)
        self.assertIn("start tactusd", printed(cells["server-train"]))
        for name in ("server-evaluate", "server-alias"):
            self.assertEqual(cells[name]["outputs"], [], name)

    def test_with_server(self):
        with Server("--data-dir=FOLDER/data") as server:
            notebook = execute(TACTUS_SERVER=server.address)
        cells = {cell["id"]: cell for cell in code_cells(notebook)}
        self.check_without_server(cells)
        self.assertIn("models/palm/versions/1", printed(cells["server-train"]))
        (evaluation,) = html(cells["server-evaluate"])
        correct = re.search(r"accuracy (\d+) of 60 ", evaluation)
        self.assertTrue(correct, evaluation)
        self.assertGreater(int(correct.group(1)), 54)
        self.assertIn("models/palm/versions/1 answers: hard", printed(cells["server-alias"]))
        (final,) = html(cells["server-alias"])
        self.assertIn("<svg", final)
        if RECORD:
            import nbformat

            nbformat.write(notebook, PATH)
        for cell in code_cells(json.loads(PATH.read_text())):
            with self.subTest(cell=cell["id"]):
                self.assertEqual(structure(cell), structure(cells[cell["id"]]),
                                 "the outputs in the file are of other cells: record them again")


if __name__ == "__main__":
    unittest.main()
