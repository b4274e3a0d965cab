// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/perception.h"

#include <algorithm>
#include <utility>

#include "daemon/pipeline/predicted_lists.h"
#include "daemon/pipeline/source_clock.h"
#include "daemon/pipeline/timeline.h"
#include "daemon/v2v/intake/own_ids.h"
#include "daemon/v2v/perception/sender_list.h"

namespace v2vouch {
namespace {

// The diagnostic list of senders can be long; ten times a second is enough for eyes.
constexpr double kV2vListPeriod_s = 0.1;

using SubjectKind = NoticeSubject::Kind;

NoticeSubject SourceOf(const EgoMotion&) { return {SubjectKind::kEgoMotion, 0}; }
NoticeSubject SourceOf(const RadarScan& scan) {
  return {SubjectKind::kRadar, static_cast<std::uint32_t>(scan.radar)};
}
NoticeSubject SourceOf(const CameraDetections& boxes) {
  return {SubjectKind::kCamera, static_cast<std::uint32_t>(boxes.camera)};
}
NoticeSubject SourceOf(const ObjectList& list) {
  return {SubjectKind::kObjects, static_cast<std::uint32_t>(list.sensor)};
}

constexpr NoticeSubject kGnssSource{SubjectKind::kGnss, 0};
constexpr NoticeSubject kV2vSource{SubjectKind::kV2v, 0};

}  // namespace

struct Perception::State {
  State(const PerceptionConfig& configuration, std::unique_ptr<BiasEstimator> estimator)
      : config(configuration),
        clock(configuration.timeline),
        timeline(configuration),
        intake(std::in_place, configuration.v2v),
        bias(std::move(estimator)) {}

  template <class OwnFrame>
  std::optional<Reason> OnOwn(const OwnFrame& message, Outputs& outputs);
  std::optional<Reason> OnFix(const GnssFix& fix, Outputs& outputs);
  std::optional<Reason> OnBsm(const Bsm& bsm, Outputs& outputs);
  void Tell(const Bsm& bsm, std::optional<Reason> refusal, Outputs& outputs) const;
  void Settle();
  void ListSenders(Outputs& outputs);
  void Restart();
  bool IsTooFarAhead(const NoticeSubject& guest, Timestamp stamp);
  [[nodiscard]] EgoPlace Place() const;
  void Publish(bool is_correction, Outputs& outputs);

  PerceptionConfig config;
  SourceClock clock;
  Timeline timeline;
  OwnIds own_ids;
  std::optional<BsmIntake> intake;  // Always there, but for a moment of Restart().
  std::unique_ptr<BiasEstimator> bias;
  std::int64_t lists = 0;
  std::int64_t v2v_lists = 0;
  int revision = 0;
  Timestamp listed{};
  Timestamp v2v_listed{};
  SenderList sender_list;
};

Perception::Perception(const PerceptionConfig& config, std::unique_ptr<BiasEstimator> bias)
    : state_(std::make_unique<State>(config, std::move(bias))) {}
Perception::~Perception() = default;
Perception::Perception(Perception&&) noexcept = default;
Perception& Perception::operator=(Perception&&) noexcept = default;

std::optional<Reason> Perception::Step(const Input& input, Outputs& outputs) {
  outputs.Clear();
  State& state = *state_;
  const auto refusal = std::visit(
      [&](const auto& message) {
        using Message = std::decay_t<decltype(message)>;
        if constexpr (std::is_same_v<Message, Bsm>) {
          return state.OnBsm(message, outputs);
        } else if constexpr (std::is_same_v<Message, GnssFix>) {
          return state.OnFix(message, outputs);
        } else {
          return state.OnOwn(message, outputs);
        }
      },
      input);
  state.Settle();
  state.ListSenders(outputs);
  return refusal;
}

template <class OwnMessage>
std::optional<Reason> Perception::State::OnOwn(const OwnMessage& message, Outputs& outputs) {
  const SourceClock::Judgement judgement = clock.Judge(SourceOf(message), message.stamp);
  if (judgement.is_restart) {
    Restart();
    outputs.Refuse(Reason::kClockRestart, message.stamp);
  }
  if (const auto refusal = RefusalOf(judgement.ruling)) {
    outputs.Refuse(*refusal, message.stamp);
    return refusal;
  }
  const auto placement = timeline.Insert(message, *clock.agreed(), outputs);
  clock.SetStrict(timeline.is_short_of_work());
  // A frame that LOCAL could not use changes nothing: the list would go out again with its old
  // time, as if it were fresh.
  if (placement.has_frame) Publish(placement.is_correction, outputs);
  return placement.refusal;
}

std::optional<Reason> Perception::State::OnFix(const GnssFix& fix, Outputs& outputs) {
  if (IsTooFarAhead(kGnssSource, fix.stamp)) {
    outputs.Refuse(Reason::kFutureStamp, fix.stamp);
    return Reason::kFutureStamp;
  }
  return timeline.Insert(fix, clock.agreed().value_or(fix.stamp), outputs).refusal;
}

std::optional<Reason> Perception::State::OnBsm(const Bsm& bsm, Outputs& outputs) {
  if (IsTooFarAhead(kV2vSource, bsm.stamp)) {
    outputs.Refuse(Reason::kFutureStamp, bsm.stamp);
    return Reason::kFutureStamp;
  }
  if (own_ids.Has(bsm.sender, bsm.stamp)) {
    Tell(bsm, Reason::kBsmOwnEcho, outputs);
    outputs.Refuse(Reason::kBsmOwnEcho, bsm.stamp);
    return Reason::kBsmOwnEcho;
  }
  const EgoPlace place = Place();
  intake->Expire(bsm.stamp);
  const auto claim = intake->Accept(bsm, place);
  if (!claim) {
    Tell(bsm, claim.reason(), outputs);
    outputs.Refuse(claim.refusal(), bsm.stamp);
    return claim.reason();
  }
  // A sender far from the ego can meet no track: it is listed and costs nothing more. A followed
  // sender that is suddenly far goes on, so that its jump is judged.
  if (place.is_known && HorizontalDistance(place.p_E, claim->p_E) > config.timeline.interest_m &&
      !timeline.priority().IsFollowed(bsm.sender)) {
    Tell(bsm, std::nullopt, outputs);
    return std::nullopt;
  }
  Claim followed = *claim;
  if (const SenderTrack* sender = intake->Find(bsm.sender)) {
    followed.first_heard = sender->first_received;
  }
  const auto placement =
      timeline.Insert(TimedClaim{followed, bsm.seq, bias->Estimate(bsm.sender, bsm.stamp)},
                      clock.agreed().value_or(bsm.stamp), outputs);
  Tell(bsm, placement.refusal, outputs);
  if (placement.refusal) return placement.refusal;
  // The sender of a validated vehicle keeps its place in the table, whatever floods it.
  const TrustState trust = timeline.priority().TrustOf(bsm.sender);
  intake->Pin(bsm.sender, trust == TrustState::kValidated || trust == TrustState::kBridged);
  return std::nullopt;
}

void Perception::State::Tell(const Bsm& bsm, std::optional<Reason> refusal,
                             Outputs& outputs) const {
  if (!config.v2v.message_verdicts) return;
  const TrustState trust = refusal ? TrustState::kNone : timeline.priority().TrustOf(bsm.sender);
  outputs.bsm_verdicts.push_back({bsm.stamp, bsm.seq, bsm.sender, trust, refusal});
}

// What can no longer change goes to the bias estimator, in order, and second by second: what it
// knew at an instant must not depend on how much became settled at once. Of the newest settled
// instant itself more may come.
void Perception::State::Settle() {
  constexpr Duration kTick{1};
  for (const BiasResidual& residual : timeline.TakeSettled()) {
    bias->AdvanceTo(residual.stamp - kTick);
    bias->Observe(residual);
  }
  if (timeline.settled() != Timestamp{}) bias->AdvanceTo(timeline.settled() - kTick);
}

// A frame only begins a list, and ends it where one piece is all.
void Perception::State::ListSenders(Outputs& outputs) {
  if (!sender_list.is_open() || (outputs.has_lists && !sender_list.is_new())) return;
  if (!sender_list.Continue(*intake, timeline.priority(), bias->report())) return;
  outputs.has_v2v_list = true;
  sender_list.Take(outputs.v2v);
  outputs.v2v.seq = ++v2v_lists;
}

void Perception::State::Restart() {
  // Penalties survive a step of the clock.
  std::vector<TrustMemory> kept = timeline.priority().TrustToKeep(timeline.newest_time());
  timeline = Timeline(config);
  timeline.RestoreTrust(std::move(kept));
  // 23 MB of tables: the old ones go before the new ones come, or what the process takes doubles.
  intake.reset();
  intake.emplace(config.v2v);
  bias->Restart();
  listed = {};
  v2v_listed = {};
  sender_list = {};
  revision = 0;
}

bool Perception::State::IsTooFarAhead(const NoticeSubject& guest, Timestamp stamp) {
  return clock.JudgeGuest(guest, stamp) == SourceClock::Ruling::kAhead;
}

EgoPlace Perception::State::Place() const {
  const Alignment& alignment = timeline.priority().alignment();
  const auto newest = timeline.local().odometry().newest();
  if (!alignment.is_ready() || !newest) return {};
  const auto ego = timeline.local().odometry().StateAt(*newest);
  if (!ego) return {};
  return PlaceOf(alignment, *ego, config.vehicle);
}

void Perception::State::Publish(bool is_correction, Outputs& outputs) {
  const LocalFrame& frame = *timeline.newest_frame();
  revision = is_correction && frame.stamp == listed ? revision + 1 : 0;
  listed = frame.stamp;
  ++lists;
  outputs.has_lists = true;

  ListLocal(frame, lists, revision, outputs.local);

  const Timestamp at = std::max(frame.stamp, timeline.newest_time());
  const EgoState ego_at = timeline.local().odometry().StateAt(at).value_or(frame.ego);
  outputs.priority = {};
  outputs.priority.stamp = at;
  outputs.priority.seq = lists;
  outputs.priority.revision = revision;
  outputs.priority.X_OB = ego_at.X_OB;
  outputs.priority.sectors = frame.sectors;
  outputs.priority.ego_gnss_suspect = timeline.priority().is_ego_gnss_suspect();
  timeline.priority().Publish(at, ego_at, outputs.priority);

  if (at - v2v_listed >= FromSeconds(kV2vListPeriod_s) && !sender_list.is_open()) {
    v2v_listed = at;
    sender_list.Open(outputs.priority, intake->senders());
  }
}

void Perception::PredictedLists(Timestamp at, Outputs& outputs) const {
  outputs.Clear();
  const State& state = *state_;
  if (state.timeline.newest_frame() == nullptr || at < newest_frame()) return;
  ListLocal(*state.timeline.newest_frame(), state.lists, state.revision, outputs.local);
  PredictLists(state.timeline, state.config, at, outputs);
}

std::optional<Timestamp> Perception::agreed_time() const { return state_->clock.agreed(); }

std::vector<TrustMemory> Perception::TrustToKeep() const {
  return state_->timeline.priority().TrustToKeep(state_->timeline.newest_time());
}

void Perception::RestoreTrust(std::vector<TrustMemory> memories) {
  state_->timeline.RestoreTrust(std::move(memories));
}

Timestamp Perception::newest_frame() const {
  const LocalFrame* frame = state_->timeline.newest_frame();
  return frame == nullptr ? Timestamp{} : frame->stamp;
}

void Perception::NoteOwnId(SenderId id, Timestamp at) { state_->own_ids.Note(id, at); }
int Perception::sender_count() const { return static_cast<int>(state_->intake->senders().size()); }

bool Perception::ego_gnss_suspect() const {
  return state_->timeline.priority().is_ego_gnss_suspect();
}

const BiasReport& Perception::bias_report() const { return state_->bias->report(); }

void Perception::CollectNotices(std::vector<Notice>& notices) const {
  state_->clock.CollectNotices(notices);
  state_->timeline.local().ego_reading().CollectNotices(notices);
  state_->timeline.priority().CollectNotices(notices);
  state_->intake->CollectNotices(notices);
}

bool Perception::IsAlive(SensorKey sensor) const {
  return state_->timeline.local().IsAlive(sensor);
}

}  // namespace v2vouch
