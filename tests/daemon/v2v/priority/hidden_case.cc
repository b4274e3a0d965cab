// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/v2v/priority/hidden_case.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <optional>
#include <variant>

#include "daemon/common/base/random.h"
#include "daemon/v2v/priority/priority_filter.h"
#include "tests/daemon/local/tracking/scene.h"

namespace v2vouch {
namespace {

constexpr double kDt_s = 0.05;
constexpr double kHiddenFrom_s = 6.0;
constexpr int kSteps = 200;

Timestamp At(int step) { return FromMicros(1'000'000) + FromSeconds(kDt_s * step); }

// A radar at the origin of O and a point target: range, azimuth, range rate.
Linearized PointRadar(const StateVector& x, const Eigen::Vector3d& z) {
  const double c = std::cos(x[kYaw]), s = std::sin(x[kYaw]), v = x[kSpeed];
  const double r = std::hypot(x[kX], x[kY]);
  const double ux = x[kX] / r, uy = x[kY] / r;
  const double rate = v * (ux * c + uy * s);
  Linearized m;
  m.y.resize(3);
  m.y << z[0] - r, AngleDifference(z[1], std::atan2(x[kY], x[kX])), z[2] - rate;
  m.H.setZero(3, kStateSize);
  m.H.row(0).head<2>() << ux, uy;
  m.H.row(1).head<2>() << -uy / r, ux / r;
  m.H(2, kX) = v * (c - rate / std::max(std::abs(v), 1e-9) * ux * (v < 0 ? -1 : 1)) / r;
  m.H(2, kY) = v * (s - rate / std::max(std::abs(v), 1e-9) * uy * (v < 0 ? -1 : 1)) / r;
  m.H(2, kYaw) = v * (-ux * s + uy * c);
  m.H(2, kSpeed) = ux * c + uy * s;
  m.R.setZero(3, 3);
  m.R.diagonal() << 0.25 * 0.25, std::pow(FromDegrees(0.5), 2), 0.1 * 0.1;
  return m;
}

Eigen::Vector3d Measure(const StateVector& x, Random& random) {
  const double r = std::hypot(x[kX], x[kY]);
  const double rate = x[kSpeed] * (x[kX] * std::cos(x[kYaw]) + x[kY] * std::sin(x[kYaw])) / r;
  return {r + 0.25 * random.Normal(), std::atan2(x[kY], x[kX]) + FromDegrees(0.5) * random.Normal(),
          rate + 0.1 * random.Normal()};
}

void Score(HiddenCaseFigures& figures, const KinematicState& state, const StateVector& truth) {
  const Eigen::Vector2d e = state.mean.head<2>() - truth.head<2>();
  figures.squared += e.squaredNorm();
  figures.nees += e.dot(state.covariance.topLeftCorner<2, 2>().inverse() * e);
  ++figures.count;
}

/// The sender of one run with its errors.
class Sender {
 public:
  Sender(double correlated_m, Random& random)
      : correlated_m_(correlated_m),
        random_(random),
        bias_(1.5 * Eigen::Vector2d(random.Normal(), random.Normal())),
        heading_error_(FromDegrees(0.3) * random.Normal()),
        speed_error_(0.1 * random.Normal()),
        yaw_error_(FromDegrees(0.7) * random.Normal()),
        wander_(correlated_m * Eigen::Vector2d(random.Normal(), random.Normal())) {}

  ClaimInOdometry Claim(const StateVector& truth, Timestamp stamp) {
    ClaimInOdometry claim;
    claim.stamp = stamp;
    const Eigen::Vector2d p = truth.head<2>();
    const double keep = std::exp(-2.0 * kDt_s / 30.0);
    wander_ = keep * wander_ + correlated_m_ * std::sqrt(1.0 - keep * keep) *
                                   Eigen::Vector2d(random_.Normal(), random_.Normal());
    claim.p_O = p + heading_error_ * Eigen::Vector2d(-p.y(), p.x()) + bias_ + wander_ +
                Eigen::Vector2d(random_.Normal(), random_.Normal());
    claim.yaw_rad = WrapAngle(truth[kYaw] + heading_error_ + yaw_error_ + 0.01 * random_.Normal());
    claim.speed_mps = truth[kSpeed] + speed_error_ + 0.05 * random_.Normal();
    claim.yaw_rate_radps = truth[kYawRate] + 0.01 * random_.Normal();
    claim.accel_mps2 = truth[kAccel] + 0.2 * random_.Normal();
    return claim;
  }

 private:
  double correlated_m_;
  Random& random_;
  Eigen::Vector2d bias_;
  double heading_error_, speed_error_, yaw_error_;
  Eigen::Vector2d wander_;
};

void Accelerate(StateVector& truth, double t_s, double sway) {
  truth[kAccel] = 1.2 * std::sin(0.9 * t_s + sway);
  truth[kYawRate] = 0.06 * std::sin(0.7 * t_s + 2.0 * sway);
}

PriorityFilter NewFilter(const KinematicState& start, Timestamp stamp,
                         const PriorityFilterConfig& config) {
  return {
      start, stamp, Eigen::Vector2d::Zero(), 2.25 * Eigen::Matrix2d::Identity(), FromDegrees(0.3),
      config};
}

void RunPoint(const HiddenCase& settings, Random& random, HiddenCaseResult& result) {
  const PriorityFilterConfig config;
  Sender sender(settings.correlated_m, random);
  const double sway = random.Uniform(0.0, 2.0 * kPi);
  StateVector truth;
  truth << 90.0, 3.5, kPi, 10.0, 0.0, 0.0;
  KinematicState start;
  start.mean = truth;
  start.covariance.diagonal() << 0.3, 0.3, 0.01, 0.2, 0.01, 0.5;
  const Eigen::LLT<StateMatrix> root(start.covariance);
  StateVector draw;
  for (double& d : draw) d = random.Normal();
  start.mean += root.matrixL() * draw;
  KinematicState local = start;
  PriorityFilter filter = NewFilter(start, At(0), config);

  bool is_healthy = true;
  for (int step = 1; step <= kSteps; ++step) {
    const double t_s = kDt_s * step;
    Accelerate(truth, t_s, sway);
    const double middle = truth[kYaw] + 0.5 * kDt_s * truth[kYawRate];
    truth[kX] += truth[kSpeed] * kDt_s * std::cos(middle);
    truth[kY] += truth[kSpeed] * kDt_s * std::sin(middle);
    truth[kYaw] = WrapAngle(truth[kYaw] + kDt_s * truth[kYawRate]);
    truth[kSpeed] += kDt_s * truth[kAccel];

    filter.PredictTo(At(step), config);
    PredictCtra(local, kDt_s, config.motion);
    const bool is_hidden = t_s > kHiddenFrom_s;
    if (!is_hidden) {
      const Eigen::Vector3d z = Measure(truth, random);
      is_healthy &= filter.Update(PointRadar(filter.kinematics().mean, z));
      is_healthy &= UpdateWith(PointRadar(local.mean, z), local);
    }
    if (step % 2 == 0 && (!is_hidden || settings.has_claims_while_hidden)) {
      filter.Update(sender.Claim(truth, At(step)), config);
    }
    if (t_s > 2.0 && !is_hidden) {
      Score(result.seen, filter.kinematics(), truth);
      Score(result.local_seen, local, truth);
    }
    if (is_hidden) Score(result.hidden, filter.kinematics(), truth);
    if (step == kSteps) Score(result.at_end, filter.kinematics(), truth);
    is_healthy &= filter.is_healthy();
  }
  result.lost += is_healthy ? 0 : 1;
}

// The sensor measurements LOCAL's track was given, as PRIORITY takes them.
void TakeUpdates(const Tracker& tracker, const LocalTrack& track, const Extent& extent,
                 const Scene& scene, PriorityFilter& filter) {
  for (const SensorUpdate& update : tracker.updates()) {
    if (update.track_id != track.id) continue;
    const StateVector x = filter.kinematics().mean;
    std::optional<Linearized> linear;
    if (const auto* radar = std::get_if<RadarMeasurement>(&update.measurement)) {
      linear = LinearizeRadar(x, extent, scene.ego_state(), scene.vehicle.radars[0], *radar);
    } else if (const auto* camera = std::get_if<CameraMeasurement>(&update.measurement)) {
      linear = LinearizeCamera(x, extent, scene.ego_state(), scene.vehicle.cameras[0], *camera);
    }
    if (linear) filter.Update(*linear);
  }
}

void RunExtended(const HiddenCase& settings, std::uint64_t seed, Random& random,
                 HiddenCaseResult& result) {
  const PriorityFilterConfig config;
  Sender sender(settings.correlated_m, random);
  const double sway = random.Uniform(0.0, 2.0 * kPi);
  Scene scene(seed);
  scene.cars.push_back({.p_W = {90.0, 3.5}, .yaw_rad = kPi, .speed_mps = 10.0});
  Car& car = scene.cars[0];
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  std::optional<PriorityFilter> filter;
  for (int step = 1; step <= kSteps; ++step) {
    const double t_s = kDt_s * step;
    StateVector truth;
    truth << car.p_W.x(), car.p_W.y(), car.yaw_rad, car.speed_mps, 0.0, 0.0;
    Accelerate(truth, t_s, sway);
    car.accel_mps2 = truth[kAccel];
    car.yaw_rate_radps = truth[kYawRate];
    scene.Advance(kDt_s);
    truth.head<4>() << car.p_W.x(), car.p_W.y(), car.yaw_rad, car.speed_mps;
    car.is_hidden = t_s > kHiddenFrom_s;

    if (filter) filter->PredictTo(scene.now(), config);
    const auto sense = [&](auto&& look) {
      look();
      const LocalTrack* track = car.is_hidden ? nullptr : Scene::Find(tracker, car);
      if (track == nullptr) return;
      const Extent known{car.length_m, car.width_m, 0.0, 0.0};
      const bool is_known = settings.target == HiddenCaseTarget::kExtentKnown;
      if (filter) {
        TakeUpdates(tracker, *track, is_known ? known : track->extent, scene, *filter);
      } else if (t_s >= 0.5) {
        filter = NewFilter(track->state_O, scene.now(), config);
      }
    };
    sense([&] { scene.Radar(tracker); });
    if (step % 2 == 1) sense([&] { scene.Camera(tracker); });
    if (!filter) continue;
    if (step % 2 == 0 && (!car.is_hidden || settings.has_claims_while_hidden)) {
      filter->Update(sender.Claim(truth, scene.now()), config);
    }
    if (t_s > 2.0 && !car.is_hidden) {
      Score(result.seen, filter->kinematics(), truth);
      const LocalTrack* track = Scene::Find(tracker, car);
      if (track != nullptr) Score(result.local_seen, track->state_O, truth);
    }
    if (car.is_hidden) Score(result.hidden, filter->kinematics(), truth);
    if (step == kSteps) Score(result.at_end, filter->kinematics(), truth);
  }
  result.lost += filter && filter->is_healthy() ? 0 : 1;
}

}  // namespace

HiddenCaseResult RunHiddenCase(const HiddenCase& settings) {
  HiddenCaseResult result;
  Random random(settings.seed);
  for (int run = 0; run < settings.runs; ++run) {
    if (settings.target == HiddenCaseTarget::kPoint) {
      RunPoint(settings, random, result);
    } else {
      RunExtended(settings, settings.seed + static_cast<std::uint64_t>(run), random, result);
    }
  }
  return result;
}

}  // namespace v2vouch
