// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/priority_perception.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/trust/standard_classes.h"

namespace v2vouch {
namespace {

// Ego GNSS moving the alignment by more than this at once changes every residual; no sender's
// doing.
constexpr double kAlignmentStep_m = 2.0;
constexpr double kTurns_s = 0.5;       // So many seconds' turns may be saved up.
constexpr double kHeightMemory = 0.1;  // Weight of a new height in the smoothed one.

double Smoothed(const std::optional<double>& old, double value) {
  return old ? *old + kHeightMemory * (value - *old) : value;
}

}  // namespace

PriorityPerception::PriorityPerception(const PriorityConfig& config,
                                       const AlignmentConfig& alignment,
                                       const VehicleConfig& vehicle)
    : settings_(std::make_shared<const Settings>(Settings{config, vehicle})),
      alignment_(alignment, vehicle) {}

void PriorityPerception::OnFix(const GnssFix& fix, const EgoState& ego, Outputs& outputs) {
  const bool was_ready = alignment_.is_ready();
  const Point<Odometry> here = ego.X_OB.origin();
  const LocalPlane plane = alignment_.plane();
  const Point<LocalEnu> before = was_ready ? alignment_.X_LO() * here : Point<LocalEnu>{};
  if (const auto refusal = alignment_.OnFix(fix, ego)) {
    return outputs.Refuse(*refusal, fix.stamp);
  }
  if (fix.fix_type >= FixType::k3d) ego_height_m_ = Smoothed(ego_height_m_, fix.position.height_m);
  if (!was_ready || !(plane.origin() == alignment_.plane().origin())) return;
  const Point<LocalEnu> after = alignment_.X_LO() * here;
  if ((after.vector() - before.vector()).norm() < kAlignmentStep_m) return;
  // The alignment has moved under all senders at once: what was learnt of them starts again from
  // the priors, and nobody is blamed.
  const double sigma_m = settings_->priority.filter.bias_sigma_m;
  const Eigen::Matrix2d prior = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
  for (PriorityVehicle& vehicle : vehicles_) {
    vehicle.filter.ResetErrors(prior + alignment_.CovarianceAt(here.vector()),
                               settings_->priority.filter);
  }
  for (Link& link : links_) {
    link.trust.ForgetResiduals();
    link.has_last = false;
  }
}

void PriorityPerception::OnFrame(const LocalFrame& frame, const VisibilityMap& map,
                                 Outputs& outputs) {
  const PriorityConfig& config = settings_->priority;
  if (config.association == AssociationMode::kPaper) {
    return paper_.OnFrame(frame.stamp, frame.tracks, config.paper);
  }
  Remember(frame, map);
  for (PriorityVehicle& vehicle : vehicles_) StepVehicle(vehicle, frame, map, outputs);
  DropEnded();
  LookAtClaims(frame, map, outputs);
  DropEnded();
  JudgeCommonMode(frame.stamp);
  pairs_.Expire(frame.stamp, config.safe);
  std::erase_if(links_, [&](const Link& link) {
    return VehicleOf(link.sender) == nullptr &&
           ToSeconds(frame.stamp - link.last.stamp) > config.contact_s;
  });
}

void PriorityPerception::OnClaim(const Claim& claim, const EgoState& ego, Outputs& outputs) {
  const PriorityConfig& config = settings_->priority;
  if (!alignment_.is_ready()) return outputs.Refuse(Reason::kNoGnss, claim.received);
  const ClaimInOdometry here = alignment_.ToOdometry(claim, claim.received);
  if (config.association == AssociationMode::kPaper) return paper_.OnClaim(here, config.paper);

  Link* link = FollowSender(claim, here, ego);
  if (link == nullptr) return;
  PriorityVehicle* vehicle = VehicleOf(link->sender);
  if (IsSomebodyElses(*link, vehicle, here)) {
    return outputs.Refuse(Reason::kBsmContradicted, claim.received);
  }
  JudgeMessages(*link, vehicle, claim, here);
  ObservePairs(*link, here);
  if (vehicle == nullptr) vehicle = Inherit(*link, here, outputs);
  link = FindLink(claim.sender);  // Inherit may have moved it.
  CompareWithSensors(*link, vehicle, here);
  if (vehicle == nullptr) {
    TryValidate(*link, here);
  } else if (vehicle->id != 0) {  // Not torn from its LOCAL track just now.
    UseClaim(*link, *vehicle, here);
  }
  link->last = here;
  link->has_last = true;
  if (link->trust.has_penalty() || link->place.has_doubt()) {
    tombstones_.Set({.sender = link->sender,
                     .certificate = link->certificate,
                     .last = here.stamp,
                     .p_O = here.p_O,
                     .v_O = here.velocity_O(),
                     .penalty = link->trust.penalty(),
                     .place = link->place});
  } else {
    tombstones_.Remove(link->sender);
  }
  Report(*link, here.stamp, outputs);
  DropEnded();
}

void PriorityPerception::SetBiasPrior(SenderId sender, const BiasEstimate& estimate) {
  if (Link* link = FindLink(sender)) link->prior_en = estimate;
}

void PriorityPerception::Publish(Timestamp at, const EgoState& ego_at, TrackList& priority) const {
  const PriorityConfig& config = settings_->priority;
  priority.ego_gnss_suspect = is_ego_gnss_suspect();
  const bool has_place = alignment_.is_ready();
  const double height_m = has_place ? alignment_.EgoGeodetic(ego_at).height_m : 0.0;
  const auto place = [&](PublishedTrack& line) {
    if (has_place) {
      line.position = alignment_.ToGeodetic(line.track.state_O.mean.head<2>(), height_m);
    }
  };
  for (const PaperList::Entry& entry : paper_.entries()) {
    PublishedTrack line;
    line.track = entry.track;
    line.track.id = entry.id;
    if (at > entry.stamp) {
      PredictCtra(line.track.state_O, ToSeconds(at - entry.stamp), config.filter.motion);
    }
    line.local_id = entry.local_id;
    line.last_v2v = entry.last_v2v;
    line.sender = entry.sender;
    place(line);
    priority.tracks.push_back(std::move(line));
  }
  for (const PriorityVehicle& vehicle : vehicles_) {
    PublishedTrack line;
    LocalTrack& track = line.track;
    track.id = vehicle.id;
    track.start = vehicle.start;
    track.state_O = vehicle.StateAt(at, config.filter);
    track.state_O.covariance.topLeftCorner<2, 2>() += vehicle.lasting;
    track.extent = vehicle.extent;
    track.object_class = vehicle.object_class;
    track.existence = vehicle.existence;
    track.is_confirmed = true;
    track.visibility = vehicle.visibility;
    track.last_radar = vehicle.last_radar;
    track.last_camera = vehicle.last_camera;
    track.radar_hits = vehicle.radar_hits;
    track.camera_hits = vehicle.camera_hits;
    line.local_id = vehicle.is_supported ? vehicle.local_id : 0;
    line.last_v2v = vehicle.last_v2v;
    line.sender = vehicle.sender;
    line.trust = TrustOf(vehicle.sender);
    line.bridge_budget_s = std::max(0.0, vehicle.BudgetLeft_s(at, config.bridge));
    if (const auto bias = BiasOf(vehicle.sender)) {
      line.bias_east_m = bias->mean_en.x();
      line.bias_north_m = bias->mean_en.y();
    }
    place(line);
    priority.tracks.push_back(std::move(line));
  }
}

TrustState PriorityPerception::TrustOf(SenderId sender) const {
  if (const Link* link = FindLink(sender)) return link->trust.state();
  const Tombstones::Stone* stone = tombstones_.Find(sender);
  const bool has_penalty = stone != nullptr && stone->penalty.state != TrustState::kNone;
  return has_penalty ? stone->penalty.state : TrustState::kUnknown;
}

std::optional<BiasEstimate> PriorityPerception::BiasOf(SenderId sender) const {
  const auto at = std::ranges::find(vehicles_, sender, &PriorityVehicle::sender);
  if (at == vehicles_.end() || !alignment_.is_ready()) return std::nullopt;
  const Eigen::Matrix2d R_LO = alignment_.X_LO().rotation();
  return BiasEstimate{R_LO * at->filter.bias(),
                      R_LO * at->filter.bias_covariance() * R_LO.transpose()};
}

std::vector<BiasResidual> PriorityPerception::TakeResiduals() {
  return std::exchange(residuals_, {});
}

std::size_t PriorityPerception::checkpoint_bytes() const {
  return sizeof(*this) + links_.size() * sizeof(Link) + sensed_.size() * sizeof(Sensed) +
         pairs_.pairs().size_bytes() + vehicles_.size() * sizeof(PriorityVehicle) +
         paper_.entries().size_bytes();
}

const PriorityPerception::Link* PriorityPerception::FindLink(SenderId sender) const {
  const auto at = std::ranges::lower_bound(links_, sender, {}, &Link::sender);
  return at != links_.end() && at->sender == sender ? &*at : nullptr;
}

PriorityPerception::Link* PriorityPerception::FindLink(SenderId sender) {
  return const_cast<Link*>(std::as_const(*this).FindLink(sender));
}

const PriorityPerception::Sensed* PriorityPerception::FindSensed(std::uint64_t local_id) const {
  if (local_id == 0) return nullptr;
  const auto at = std::ranges::find_if(
      sensed_, [&](const Sensed& sensed) { return sensed.track.id == local_id; });
  return at == sensed_.end() ? nullptr : &*at;
}

PriorityVehicle* PriorityPerception::VehicleOf(SenderId sender) {
  const auto at = std::ranges::find_if(vehicles_, [&](const PriorityVehicle& vehicle) {
    return vehicle.sender == sender && vehicle.id != 0;
  });
  return at == vehicles_.end() ? nullptr : &*at;
}

bool PriorityPerception::IsHeld(std::uint64_t local_id) const {
  return std::ranges::any_of(vehicles_, [&](const PriorityVehicle& vehicle) {
    return vehicle.id != 0 && vehicle.local_id == local_id;
  });
}

bool PriorityPerception::HasAnotherAt(const Eigen::Vector2d& p_O, SenderId but,
                                      bool is_supported) const {
  return std::ranges::any_of(vehicles_, [&](const PriorityVehicle& vehicle) {
    return vehicle.id != 0 && vehicle.sender != but && vehicle.is_supported == is_supported &&
           (vehicle.filter.mean().head<2>() - p_O).norm() <= kOnePlace_m;
  });
}

std::optional<BiasPrior> PriorityPerception::PriorOf(const Link& link) const {
  if (!link.prior_en) return std::nullopt;
  const Eigen::Matrix2d R_OL = alignment_.X_LO().rotation().transpose();
  return BiasPrior{R_OL * link.prior_en->mean_en,
                   R_OL * link.prior_en->covariance * R_OL.transpose()};
}

PriorityPerception::Link* PriorityPerception::FollowSender(const Claim& claim,
                                                           const ClaimInOdometry& here,
                                                           const EgoState& ego) {
  const PriorityConfig& config = settings_->priority;
  Link* link = FindLink(claim.sender);
  if (link == nullptr) {
    const auto is_near = [&](const Eigen::Vector2d& p_O) {
      return (p_O - here.p_O).squaredNorm() < config.interest_m * config.interest_m;
    };
    const double distance_m = (ego.X_OB.origin().vector() - here.p_O).norm();
    const bool is_of_interest =
        distance_m < config.trust.place.max_distance_m ||
        std::ranges::any_of(
            sensed_,
            [&](const Sensed& sensed) { return is_near(sensed.track.state_O.mean.head<2>()); }) ||
        std::ranges::any_of(vehicles_, [&](const PriorityVehicle& vehicle) {
          return is_near(vehicle.filter.mean().head<2>());
        });
    if (!is_of_interest) return nullptr;
    const bool is_full = links_.size() >= static_cast<std::size_t>(config.max_senders);
    if (is_full && !TakeTurn(here.stamp)) return nullptr;
    const Tombstones::Stone* own = tombstones_.Find(claim.sender);
    std::optional<Tombstones::Stone> stone;
    if (own != nullptr) {
      stone = *own;
    } else {
      stone = tombstones_.TakeFor(claim.sender, claim.certificate, claim.first_heard, here.stamp,
                                  here.p_O, here.velocity_O(), config.trust.tombstone);
    }
    const bool is_penalised = stone && stone->penalty.state != TrustState::kNone;
    if (is_full && !MakeRoom(is_penalised)) return nullptr;
    const auto at = std::ranges::lower_bound(links_, claim.sender, {}, &Link::sender);
    link = &*links_.insert(at, Link{});
    link->sender = claim.sender;
    link->last = here;
    if (stone) {
      link->trust.Inherit(stone->penalty);
      link->place = stone->place;
    }
  }
  link->length_m = claim.length_m;
  link->width_m = claim.width_m;
  link->certificate = claim.certificate;
  link->is_accuracy_poor = claim.accuracy_is_poor;
  if (claim.has_elevation) link->height_m = Smoothed(link->height_m, claim.height_m);
  return link;
}

// Where more senders speak near by than can be followed, each keeps its place long enough to be
// judged: were everyone let in at once, nobody's second message would find the first's record.
bool PriorityPerception::TakeTurn(Timestamp now) {
  const double rate_hz = settings_->priority.turnover_hz;
  if (turns_refilled_) {
    const double since_s = std::max(0.0, ToSeconds(now - *turns_refilled_));
    turns_ = std::min(kTurns_s * rate_hz, turns_ + since_s * rate_hz);
  } else {
    turns_ = kTurns_s * rate_hz;
  }
  turns_refilled_ = now;
  if (turns_ < 1.0) return false;
  turns_ -= 1.0;
  return true;
}

// Room is made by whom the least is lost with: the penalised, whose stones remember them, then
// strangers away from all tracks, then other strangers; among equals whoever was not heard for
// longest. Nobody with a vehicle is given up, so that no flood of identities drives them out.
bool PriorityPerception::MakeRoom(bool for_penalised) {
  const auto rank = [&](const Link& link) {
    if (link.trust.has_penalty()) return 0;
    return pairs_.AssignedTo(link.sender) == nullptr ? 1 : 2;
  };
  auto least = links_.end();
  int least_rank = 0;
  for (auto link = links_.begin(); link != links_.end(); ++link) {
    if (VehicleOf(link->sender) != nullptr) continue;
    const int link_rank = rank(*link);
    if (for_penalised && link_rank > 0) continue;
    if (least == links_.end() ||
        std::pair(link_rank, link->last.stamp) < std::pair(least_rank, least->last.stamp)) {
      least = link;
      least_rank = link_rank;
    }
  }
  if (least == links_.end()) return false;
  pairs_.DropSender(least->sender);
  links_.erase(least);
  return true;
}

void PriorityPerception::EndVehicle(PriorityVehicle& vehicle, Timestamp stamp) {
  vehicle.id = 0;
  pairs_.SetIncumbent(vehicle.sender, std::nullopt);
  if (Link* link = FindLink(vehicle.sender)) link->trust.Release(stamp);
}

void PriorityPerception::DropEnded() {
  std::erase_if(vehicles_, [](const PriorityVehicle& vehicle) { return vehicle.id == 0; });
}

void PriorityPerception::Report(Link& link, Timestamp stamp, Outputs& outputs) {
  const auto judgement = link.trust.TakeVerdict();
  if (!judgement) return;
  MisbehaviorReport report;
  report.stamp = stamp;
  report.sender = link.sender;
  report.certificate = link.certificate;
  report.check = judgement->finding.check;
  report.verdict = judgement->verdict;
  if (const auto standard = StandardClassOf(report.check)) {
    report.etsi_class = standard->etsi_class;
    report.is_j3287 = standard->is_j3287;
  }
  report.evidence = {{judgement->finding.quantity, judgement->finding.value},
                     {"limit", judgement->finding.limit}};
  outputs.reports.push_back(std::move(report));
  if (PriorityVehicle* vehicle = VehicleOf(link.sender)) {
    link.withdrawn_id = vehicle->local_id;
    EndVehicle(*vehicle, stamp);
  }
}

}  // namespace v2vouch
