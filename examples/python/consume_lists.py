#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Vehicles round the car, from both lists. Usage: consume_lists.py [LOG.lcm] [--url URL]"""

import math
import sys

import v2vouch_lcm

WATCHED_CHANNELS = {"TRACKS_LOCAL", "TRACKS_PRIORITY"}


class Surroundings:
    """PRIORITY where it speaks, LOCAL for the others."""

    def __init__(self, types):
        self.types, self.local, self.priority = types, None, None

    def take(self, channel, new):
        old = self.local if channel == "TRACKS_LOCAL" else self.priority
        if old and new.utime < old.utime and old.utime - new.utime < 1_000_000:
            return  # Reordered on the way. More than a second back: the daemon has started anew.
        # The same utime again is a correction by late data (revision counts up): it replaces the list.
        if channel == "TRACKS_LOCAL":
            self.local = new
        else:
            self.priority = new

    def vehicles(self):
        """[(track, is_priority)]; a vehicle that is in both lists comes once."""
        priority = self.priority.tracks if self.priority else []
        kind = self.types.track_t
        trusted = [t for t in priority if t.trust_state not in (kind.TRUST_SUSPECT, kind.TRUST_REVOKED)]
        rests_on = {t.local_id for t in trusted if t.local_id}  # 0: hidden now, kept by V2V.
        own = [t for t in (self.local.tracks if self.local else []) if t.id not in rests_on]
        return [(t, True) for t in trusted] + [(t, False) for t in own]

    def is_blind(self, azimuth_rad):
        """Whether "no vehicle there" would mean nothing."""
        if not self.local:
            return True
        inside = [s for s in self.local.sectors
                  if (azimuth_rad - s.from_rad) % (2 * math.pi) <= (s.to_rad - s.from_rad) % (2 * math.pi)]
        return all(s.state == self.types.sector_health_t.BLIND for s in inside)


def main():
    arguments = [a for a in sys.argv[1:] if not a.startswith("--")]
    types = v2vouch_lcm.Types()
    if "--url" in sys.argv:
        source = v2vouch_lcm.listen(types, WATCHED_CHANNELS, sys.argv[sys.argv.index("--url") + 1])
    elif arguments:
        source = v2vouch_lcm.read_log(arguments[0], types)
    else:
        source = v2vouch_lcm.listen(types, WATCHED_CHANNELS)
    around, second = Surroundings(types), None
    for _, channel, message in source:
        if channel not in WATCHED_CHANNELS:
            continue
        around.take(channel, message)
        if message.utime // 1_000_000 == second:
            continue
        second = message.utime // 1_000_000
        state = "stale: predicted, no frame for 100 ms" if message.stale else "fresh"
        print(f"{message.utime * 1e-6:.2f} {state}, ahead {'BLIND' if around.is_blind(0) else 'watched'}")
        for track, is_priority in around.vehicles():
            print(f"  {'PRIORITY' if is_priority else 'LOCAL':8} x {track.x_body_m:6.1f} y {track.y_body_m:6.1f} m "
                  f"{track.speed_mps:5.1f} m/s{' hidden' if is_priority and not track.local_id else ''}")


if __name__ == "__main__":
    try:
        main()
    except (BrokenPipeError, KeyboardInterrupt):
        pass
