#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Evaluates the tracks that v2vouch-bench-tracker --kitti wrote a second time, with the reference
data's own mot3d.py, and compares. Usage: clear3d_oracle_test.py BENCH DATA_FOLDER"""
import json
import os
import subprocess
import sys
import tempfile

bench, data = sys.argv[1], os.path.join(os.environ.get('V2VOUCH_DATA', sys.argv[2]),
                                        'kitti_pointrcnn')
if not os.path.exists(os.path.join(data, 'mot3d.py')):
    print('SKIPPED: no kitti_pointrcnn under V2VOUCH_DATA')
    sys.exit(77)

oracle = {'__name__': 'oracle'}
source = open(os.path.join(data, 'mot3d.py')).read()
exec(source[:source.rindex('\nmain()')], oracle)

with tempfile.TemporaryDirectory() as tracks:
    where = [os.path.join(data, part) for part in ('det_car', 'label_02', 'seqmap.train')]
    run = subprocess.run([bench, '--kitti', *where, '--json', '--tracks', tracks],
                         capture_output=True, text=True, check=True)
    ours = json.loads(run.stdout)
    sequences = []
    for line in open(where[2]):
        words = line.split()
        if not words:
            continue
        truth = oracle['load_gt'](os.path.join(where[1], words[0] + '.txt'), True)
        rows = []
        for row in open(os.path.join(tracks, words[0] + '.txt')):
            c = row.split()
            v = [float(x) for x in c[6:18]]
            rows.append((int(c[0]), int(c[1]), v[11], tuple(v[4:11]), tuple(v[0:4])))
        sequences.append((max([int(words[3])] + [f + 1 for f in truth]), truth, rows))
    theirs = oracle['evaluate'](sequences, 0.25, True)

faults = 0
for name, key, slack in (('samota', 'sAMOTA', 0.05), ('amota', 'AMOTA', 0.05),
                         ('mota', 'MOTA', 0.05), ('motp', 'MOTP', 0.05), ('ids', 'IDS', 0),
                         ('frag', 'FRAG', 1), ('gt', 'GT', 0)):
    good = abs(ours[name] - theirs[key]) <= slack
    faults += not good
    print(f"{name}: {ours[name]:.3f}, oracle {theirs[key]:.3f}{'' if good else '  DIFFERS'}")
sys.exit(1 if faults else 0)
