# SPDX-License-Identifier: Apache-2.0
"""Tests of scripts/demo_table.py."""

import contextlib
import io
import json
import os
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "scripts"))
import demo_table  # noqa: E402


def lists(gospa):
    return {name: {"gospa_mean": gospa + k, "missed_mean": 1.0, "false_mean": 0.5,
                   "switching_mean": 0.0, "bound_mean": 2.0, "ratio": 1.5,
                   "localisation_rms_m": 0.25, "false_tracks_total": 0, "switches": 0}
            for k, name in enumerate(demo_table.LISTS)}


EVALUATION = {
    "lists": lists(3.0), "all_vehicles": lists(11.0),
    "paper_method": {"lists": lists(5.0), "all_vehicles": lists(21.0)},
    "hidden": {"rms_m": None, "max_m": None, "seconds": 0.0},
    "gates": {"local_false": {"value": 0.5, "limit": 0.02, "pass": False}},
}


def run(*texts):
    out, err = io.StringIO(), io.StringIO()
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for k, text in enumerate(texts):
            paths.append(os.path.join(folder, f"{k}.json"))
            with open(paths[-1], "w", encoding="utf-8") as file:
                file.write(text)
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = demo_table.main(paths)
    return code, out.getvalue(), err.getvalue()


class DemoTable(unittest.TestCase):
    def test_the_papers_row_its_method_ours_and_the_bound_stand_beneath_each_other(self):
        code, out, _ = run(json.dumps(EVALUATION), json.dumps(EVALUATION))
        self.assertEqual(0, code)
        rows = [line.split() for line in out.splitlines()]
        self.assertEqual(["56.12", "7.52", "48.62"], rows[2][-3:])
        self.assertEqual(["21.00", "22.00", "23.00"], rows[3][-3:])
        self.assertEqual(["11.00", "12.00", "13.00"], rows[4][-3:])
        self.assertEqual(["2.00", "2.00", "2.00"], rows[5][-3:])

    def test_a_missed_gate_and_missing_figures_show(self):
        _, out, _ = run(json.dumps(EVALUATION), json.dumps(EVALUATION))
        self.assertIn("gate MISS local_false: 0.5000 (at most 0.02)", out)
        self.assertIn("Hidden vehicles in PRIORITY: none", out)

    def test_unreadable_or_incomplete_input_is_an_error(self):
        self.assertEqual(1, run("{", "{}")[0])
        code, _, err = run("{}", "{}")
        self.assertEqual(1, code)
        self.assertIn("lacks", err)
        self.assertEqual(2, run("{}")[0])


if __name__ == "__main__":
    unittest.main()
