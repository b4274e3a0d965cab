#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every script answers --help with its usage and exit code 0, and does nothing else."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Help(unittest.TestCase):
    def test_every_script_answers_help(self):
        scripts = sorted(path for path in (ROOT / "scripts").iterdir()
                         if path.is_file() and os.access(path, os.X_OK))
        self.assertGreater(len(scripts), 20)
        with tempfile.TemporaryDirectory() as folder:
            running = [(script.name, subprocess.Popen(
                [script, "--help"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                text=True, cwd=folder)) for script in scripts]
            for name, process in running:
                output, _ = process.communicate(timeout=60)
                with self.subTest(script=name):
                    self.assertEqual(process.returncode, 0, output)
                    self.assertIn("usage", output.lower())
            self.assertEqual(os.listdir(folder), [])


if __name__ == "__main__":
    sys.exit(unittest.main())
