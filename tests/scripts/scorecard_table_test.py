#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of scripts/scorecard_table.py."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import scorecard_table  # noqa: E402

COLUMNS = [("RMS", lambda card: card["rms"], 2, True), ("kept %", lambda card: card["kept"], 0, False),
           ("lists", lambda card: card["lists"], 0, None)]


def result(rms, kept, lists=7):
    card = {"rms": rms, "kept": kept, "lists": lists}
    return {"scorecard": {"local": card, "priority": card}}


class Table(unittest.TestCase):
    def rows(self, text):
        return [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines()[2:]]

    def test_the_worst_row_is_the_most_or_the_least_by_column(self):
        values = {name: scorecard_table.values_of(row, "local", COLUMNS)
                  for name, row in (("a", result(1.0, 90)), ("b", result(2.5, 95)))}
        rows = self.rows(scorecard_table.table(values, "log", COLUMNS))
        self.assertEqual(rows, [["a", "1.00", "90", "7"], ["b", "2.50", "95", "7"],
                                ["**worst**", "2.50", "90", "-"]])

    def test_a_value_that_is_not_there_is_no_worst(self):
        values = {"a": [None, None, 3], "b": [0.5, 80, 3]}
        rows = self.rows(scorecard_table.table(values, "log", COLUMNS))
        self.assertEqual(rows[0], ["a", "-", "-", "3"])
        self.assertEqual(rows[2], ["**worst**", "0.50", "80", "-"])

    def test_settings_stand_behind_the_vehicle(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            vehicle = folder / "v.yaml"
            vehicle.write_text("vehicle:\n  length_m: 4\n")
            path = scorecard_table.settings_file(vehicle, ["tracking.point_targets=true"], folder)
            self.assertEqual(path.read_text(),
                             "vehicle:\n  length_m: 4\ntracking:\n  point_targets: true\n")


if __name__ == "__main__":
    unittest.main()
