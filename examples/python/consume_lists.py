#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Vehicles round the car, from both lists. Usage: consume_lists.py [LOG.lcm | udpm://GROUP:PORT]"""
import math
import sys

import v2vouch_lcm


class Surroundings:
    """PRIORITY where it speaks, LOCAL for the others."""

    def __init__(self, types):
        self.types, self.lists = types, {}

    def take(self, channel, new):
        old = self.lists.get(channel)
        # Reordered on the way: too late. More than a second back: the daemon has started anew. The same utime
        # once more is a correction by late data (revision counts up) and replaces the list.
        if not old or not old.utime - 1_000_000 < new.utime < old.utime:
            self.lists[channel] = new

    def vehicles(self):
        """[(track, is_priority)]; a vehicle in both lists comes once. SUSPECT and REVOKED: LOCAL's word alone."""
        kind, local, priority = self.types.track_t, self.lists.get("TRACKS_LOCAL"), self.lists.get("TRACKS_PRIORITY")
        distrusted = (kind.TRUST_SUSPECT, kind.TRUST_REVOKED)
        trusted = [t for t in priority.tracks if t.trust_state not in distrusted] if priority else []
        rests_on = {t.local_id for t in trusted if t.local_id}  # 0: hidden now, kept by V2V.
        others = [t for t in local.tracks if t.id not in rests_on] if local else []
        return [(t, True) for t in trusted] + [(t, False) for t in others]

    def is_blind(self, azimuth_rad):
        """Whether "no vehicle there" would mean nothing."""
        local, turn = self.lists.get("TRACKS_LOCAL"), 2 * math.pi
        return all(s.state == self.types.sector_health_t.BLIND for s in (local.sectors if local else [])
                   if (azimuth_rad - s.from_rad) % turn <= (s.to_rad - s.from_rad) % turn)


def main(source=""):
    types, second = v2vouch_lcm.Types(), None
    around, channels = Surroundings(types), {"TRACKS_LOCAL", "TRACKS_PRIORITY"}
    is_log = source and not source.startswith("udpm://")
    messages = v2vouch_lcm.read_log(source, types) if is_log else v2vouch_lcm.listen(types, channels, source)
    for _, channel, message in messages:
        if channel not in channels:
            continue
        around.take(channel, message)
        if message.utime // 1_000_000 == second:
            continue
        second = message.utime // 1_000_000
        state = "stale: predicted, no frame for 100 ms" if message.stale else "fresh"
        print(f"{message.utime * 1e-6:.2f} {state}, ahead {'BLIND' if around.is_blind(0) else 'watched'}")
        for t, is_priority in around.vehicles():
            hidden = " hidden" if is_priority and not t.local_id else ""
            print(f"  {'PRIORITY' if is_priority else 'LOCAL':8} x {t.x_body_m:6.1f} y {t.y_body_m:6.1f} m "
                  f"{t.speed_mps:5.1f} m/s{hidden}")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:2])
    except (BrokenPipeError, KeyboardInterrupt):
        pass
