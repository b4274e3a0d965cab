#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""scripts/check_size.py on pieces of source."""
import os
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts"))
import check_size  # noqa: E402


def found(text):
    return [(kind, name, last - first + 1) for kind, name, first, last, _ in check_size.blocks(text)]


class Blocks(unittest.TestCase):
    def test_a_function_is_measured_from_its_name_to_its_brace(self):
        self.assertEqual(found("namespace a {\n\nint\nF(int x) {\n  return x;\n}\n}\n"), [("function", "F", 3)])

    def test_lambdas_and_initialisers_are_part_of_their_function(self):
        text = "void F() {\n  const auto f = [](int x) {\n    return x;\n  };\n  int a[] = {1, 2};\n}\n"
        self.assertEqual(found(text), [("function", "F", 6)])

    def test_a_constructor_with_initialisers_is_one_function(self):
        text = "A::A(int x)\n    : x_{x},\n      y_(1) {\n  Use();\n}\n"
        self.assertEqual(found(text), [("function", "A::A", 5)])

    def test_functions_inside_a_class_have_its_name(self):
        text = "class A : public B {\n public:\n  int F() const { return 1; }\n  int x_ = 0;\n};\n"
        self.assertEqual(found(text), [("function", "A::F", 1), ("type", "A", 5)])

    def test_braces_in_strings_and_comments_do_not_count(self):
        text = 'int F() {\n  // {\n  const char* a = "{{";\n  char b = \'{\';\n  /* } */\n  return R"({)"[0] + a[0] + b;\n}\n'
        self.assertEqual(found(text), [("function", "F", 7)])

    def test_tables_are_neither_functions_nor_types(self):
        self.assertEqual(found("constexpr Field kFields[] = {\n    {.name = \"a\"},\n};\n"), [])


if __name__ == "__main__":
    unittest.main()
