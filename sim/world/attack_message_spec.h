// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "daemon/common/base/visit.h"

/// The blocks of an attack's `change` list (attack_change_spec.h) that change what else is said,
/// how often, when and under which name.
namespace v2vouch::sim {

/// Another size.
struct SizeChangeSpec {
  double scale = 1.0;
  bool swap = false;       ///< Length for width.
  double random_to = 0.0;  ///< Per message: both times a factor from 0.3 to here; 0 = not.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("scale", scale, {.above = 0.0, .at_most = 20.0});
    a.Field("swap", swap);
    a.Field("random_to", random_to, {.at_least = 0.0, .at_most = 20.0});
  }
};

/// Another reported accuracy.
struct AccuracySpec {
  double semi_major_m = 12.7;
  bool unavailable = false;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("semi_major_m", semi_major_m, {.at_least = 0.0, .at_most = 12.7});
    a.Field("unavailable", unavailable);
  }
};

/// Says what was so a while ago.
struct DelaySpec {
  double low_s = 1.0;    ///< Age, drawn once from here ...
  double high_s = 1.0;   ///< ... to here.
  int messages = 0;      ///< Instead: so many messages ago.
  bool restamp = false;  ///< Stamps of now instead of the content's own.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("low_s", low_s, {.at_least = 0.0, .at_most = 600.0});
    a.Field("high_s", high_s, {.at_least = 0.0, .at_most = 600.0});
    a.Field("messages", messages, {.at_least = 0, .at_most = 6000});
    a.Field("restamp", restamp);
  }
};

/// Sends messages again that were sent before.
struct ReplaySpec {
  enum class Of { kOwn, kVictim };
  enum class Stamps {
    kKept,    ///< Bit for bit, but for a victim's identity and count.
    kFresh,   ///< secMark and signature of now.
    kMinute,  ///< As if exactly 60.000 s old: secMark of now, signature of a minute ago.
  };
  Of of = Of::kOwn;
  double age_s = 6.0;       ///< Older than all that was sent: reckoned back at constant velocity.
  int low = 6;              ///< Of a victim: so many messages at a time, from here ...
  int high = 6;             ///< ... to here, then the next victim.
  double within_m = 400.0;  ///< Victims are heard from within this distance.
  Stamps stamps = Stamps::kKept;

  template <class Archive>
  void Visit(Archive& a) {
    a.Choice("of", of, {{"own", Of::kOwn}, {"victim", Of::kVictim}});
    a.Field("age_s", age_s, {.at_least = 0.0, .at_most = 600.0});
    a.Field("low", low, {.at_least = 1, .at_most = 1000});
    a.Field("high", high, {.at_least = 1, .at_most = 1000});
    a.Field("within_m", within_m, {.above = 0.0, .at_most = 1e5});
    a.Choice("stamps", stamps,
             {{"kept", Stamps::kKept}, {"fresh", Stamps::kFresh}, {"minute", Stamps::kMinute}});
  }
};

/// A new TemporaryID, certificate and message count; the parts add up.
struct IdentityChangeSpec {
  int every_messages = 0;  ///< 0 = not.
  double every_s = 0.0;    ///< 0 = not.
  bool at_once = false;    ///< One with the block's beginning.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("every_messages", every_messages, {.at_least = 0, .at_most = 100000});
    a.Field("every_s", every_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("at_once", at_once);
  }
};

/// The TemporaryID of another sender: of the vehicle spoken for if it talks, else of the talking
/// vehicle longest in joint view.
struct ImpersonateSpec {
  enum class Certificate { kOwn, kNone };
  std::uint32_t vehicle = 0;                    ///< 0 = as said above.
  Certificate certificate = Certificate::kOwn;  ///< kNone: signature state unknown.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("vehicle", vehicle, {.at_most = 4e9});
    a.Choice("certificate", certificate,
             {{"own", Certificate::kOwn}, {"none", Certificate::kNone}});
  }
};

/// So many times as many messages, evenly spread, each with the place it claims to have then.
struct RateSpec {
  double times = 4.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("times", times, {.at_least = 1.0, .at_most = 2000.0});
  }
};

}  // namespace v2vouch::sim
