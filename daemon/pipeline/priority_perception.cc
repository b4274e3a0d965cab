// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/priority_perception.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/geodesy/ecef.h"
#include "daemon/trust/standard_classes.h"

namespace v2vouch {
namespace {

// Ego GNSS moving the alignment by more than this at once changes every residual; no sender's
// doing.
constexpr double kAlignmentStep_m = 2.0;

}  // namespace

PriorityPerception::PriorityPerception(const PriorityConfig& config,
                                       const AlignmentConfig& alignment,
                                       const VehicleConfig& vehicle)
    : settings_(std::make_shared<const Settings>(Settings{config, vehicle})),
      alignment_(alignment, vehicle) {}

void PriorityPerception::OnFix(const GnssFix& fix, const EgoState& ego, Outputs& outputs) {
  const bool was_ready = alignment_.is_ready();
  const Point<Odometry> here = ego.X_OB.origin();
  const Wgs84 before = was_ready ? alignment_.ToGeodetic(here.vector(), 0.0) : Wgs84{};
  if (const auto refusal = alignment_.OnFix(fix, ego)) {
    return outputs.Refuse(*refusal, fix.stamp);
  }
  if (!alignment_.is_ready()) return;
  const double moved_m = ego_heights_at_ ? (here.vector() - *ego_heights_at_).norm() : 0.0;
  ego_heights_at_ = here.vector();
  const bool has_height = fix.has_height && fix.fix_type >= FixType::k3d;
  ego_heights_.Add(ego.stamp, std::copysign(moved_m, ego.speed_mps),
                   has_height ? std::optional(fix.position.height_m) : std::nullopt);
  if (!was_ready) return;
  const Wgs84 after = alignment_.ToGeodetic(here.vector(), 0.0);
  if ((ToEcef(after).p_E - ToEcef(before).p_E).norm() < kAlignmentStep_m) return;
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
  restored_.OnEvent(frame.stamp);
  Remember(frame, map);
  for (PriorityVehicle& vehicle : vehicles_) StepVehicle(vehicle, frame, map, outputs);
  DropEnded();
  LookAtClaims(frame, map, outputs);
  DropEnded();
  JudgeCommonMode(frame.stamp);
  JudgeHeights(frame.stamp);
  pairs_.Expire(frame.stamp, config.safe);
  pairs_apart_.Expire(frame.stamp, config.safe);
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

  // Who says itself that it is lost tells its motion, no place.
  const bool has_place = !claim.accuracy_is_poor;
  if (!has_place && FindLink(claim.sender) == nullptr) return;
  Link* link = FollowSender(claim, here, ego);
  if (link == nullptr) return;
  PriorityVehicle* vehicle = VehicleOf(link->sender);
  FollowHeight(*link, claim, here, ego);
  if (has_place && IsSomebodyElses(*link, vehicle, here)) {
    return outputs.Refuse(Reason::kBsmContradicted, claim.received);
  }
  JudgeMessages(*link, vehicle, claim, here);
  if (has_place) {
    ObservePairs(*link, here);
    if (vehicle == nullptr) vehicle = Inherit(*link, here, outputs);
    link = FindLink(claim.sender);  // Inherit may have moved it.
    CompareWithSensors(*link, vehicle, here);
    if (vehicle == nullptr) {
      TryValidate(*link, here);
    } else if (vehicle->id != 0) {  // Not torn from its LOCAL track just now.
      UseClaim(*link, *vehicle, here);
    }
  } else if (vehicle != nullptr) {
    UseMotion(*link, *vehicle, here);
  }
  if (has_place) {
    link->last = here;
    link->has_last = true;
  }
  if (link->trust.has_penalty() || link->place.has_doubt()) {
    tombstones_.Set({.sender = link->sender,
                     .certificate = link->certificate,
                     .last = link->last.stamp,
                     .p_O = link->last.p_O,
                     .v_O = link->last.velocity_O(),
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
  if (has_penalty) return stone->penalty.state;
  const TrustState restored = restored_.StateOf(sender);
  const bool is_penalty = restored == TrustState::kSuspect || restored == TrustState::kRevoked;
  return is_penalty ? restored : TrustState::kUnknown;
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
         pairs_.pairs().size_bytes() + pairs_apart_.pairs().size_bytes() +
         vehicles_.size() * sizeof(PriorityVehicle) + paper_.entries().size_bytes();
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
