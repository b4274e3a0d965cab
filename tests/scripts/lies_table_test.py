#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""scripts/lies_table: counts by attack and variant, both scenarios, and bars of shares."""
import json, os, subprocess, sys, tempfile, xml.dom.minidom


def consumer(urgent, warn, needless):
    kinds = {'FCW': {'urgent_by_lie': urgent, 'false_by_lie': warn}, 'IMA': {'urgent_by_lie': 0, 'false_by_lie': 0}}
    return {'kinds': kinds, 'planner': {'needless': needless}}


def main():
    with tempfile.TemporaryDirectory() as study:
        os.mkdir(os.path.join(study, 'runs'))
        quiet = consumer(0, 0, False)
        for name, v2v in (('A2-stop.campaign_urban.d0.s1', consumer(2, 3, True)),
                          ('A2-stop.campaign_highway.d0.s1', quiet),
                          ('A10-delay_2_4s.campaign_urban.d0.s1', consumer(0, 1, False)),
                          ('A3-far.campaign_urban.d0.s1', quiet), ('A3-near.campaign_urban.d0.s1', quiet),
                          ('plain.campaign_urban.d0.s1', consumer(9, 9, True)),
                          ('H1-bias.campaign_urban.d0.s1', consumer(9, 9, True))):
            with open(os.path.join(study, 'runs', name + '.json'), 'w') as f:
                json.dump({'warnings': {'consumers': {'v2v': v2v, 'local': quiet, 'ours': quiet}}}, f)

        def run(*args):
            return subprocess.run([sys.executable, 'scripts/lies_table', study, *args], capture_output=True, text=True,
                                  check=True).stdout

        drawn = os.path.join(study, 'lies.svg')
        none = ' 0 | 0 | 0 | 0 | 0 | 0 |'
        assert run('--svg', drawn).splitlines()[2:] == [
            '| A2 | 2 | 2, in 1 | 3 | 1 |' + none, '| A10 | 1 | 0 | 1 | 0 |' + none,
            '| the others | 2 | 0 | 0 | 0 |' + none, '| **all** | 5 | 2, in 1 | 4 | 1 |' + none]
        texts = [t.firstChild.data for t in xml.dom.minidom.parse(drawn).getElementsByTagName('text')]
        assert [t for t in texts if t[0] == 'A'] == ['A2', 'A3', 'A10'], texts
        assert texts.count('1 of 2') == 2 and texts.count('1 of 1') == 1, texts
        assert '| A10 delay_2_4s | 1 | 0 | 1 | 0 |' + none in run('--variants')
        assert '**all** | 1 | 0 | 0 | 0 |' in run('--scenario', 'campaign_highway')
    return 0


if __name__ == '__main__':
    sys.exit(main())
