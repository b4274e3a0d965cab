// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "daemon/common/data/bias.h"
#include "daemon/common/data/calibration.h"
#include "daemon/v2v/gps_bias/gps_bias_config.h"

namespace v2vouch {

/// One sensor-confirmed difference between where a sender says it is and where it was seen, with
/// how it moved and from where it was seen.
struct RemotePair {
  BiasResidual residual;
  Eigen::Vector2d velocity_en_mps = Eigen::Vector2d::Zero();
  double range_m = 0.0;
  double bearing_rad = 0.0;  ///< From the ego, counter-clockwise from east.
};

struct RemoteRules {
  double min_span_s = 30.0;
  int min_pairs = 200;
  double min_bearing_spread_rad = 0.7;       ///< 40 degrees; this, or ...
  double min_range_spread_m = 20.0;          ///< ... this: else a turned world looks like a bias.
  double min_velocity_variance_m2ps2 = 4.0;  ///< Below, latency and bias cannot be told apart.
  double latency_sigma_s = 0.1;
  double max_latency_s = 0.5;
  double offset_sigma_m = 0.3;       ///< Of the reference point, along its heading.
  double slope_sigma = 4.5;          ///< A drift this clear ...
  double slope_mps = 0.015;          ///< ... and this fast is no receiver's.
  double turn_sigma = 4.5;           ///< A world turned about the ego this clearly ...
  double turn_rad = 0.0175;          ///< ... and by so much (1 degree) is none either.
  double leave_one_out_gate = 20.0;  ///< Chi-square, 2 dof: 5 in 100 000 honest ones.
  GpsBiasConfig noise;               ///< Gauss-Markov wandering, white rate, bounds.
};

/// What one sender's claims are off by, over a whole drive. Of the claim made at t
///
///     claimed - sensed = b + w(t) + c e - v tau + noise
///
/// with constant bias b (east, north; relative to the ego's own), Gauss-Markov wandering w, offset
/// c of the reference point along the heading e, and latency tau: the place told was older than its
/// stamp by so much.
struct RemoteSolution {
  SenderId sender = 0;
  int pairs = 0;
  double span_s = 0.0;
  Eigen::Vector2d bias_en = Eigen::Vector2d::Zero();
  Eigen::Matrix2d bias_covariance = Eigen::Matrix2d::Identity();  ///< Consider part included.
  double latency_s = 0.0;
  double latency_std_s = 0.0;
  double offset_m = 0.0;
  double offset_std_m = 0.0;
  double chi_square_per_dof = 0.0;
  double wander_chi_square = 0.0;  ///< Per degree of freedom, against a receiver's wandering.
  double slope_mps = 0.0;
  double turn_rad = 0.0;      ///< By which its world looks turned about the ego, left positive, ...
  double turn_std_rad = 0.0;  ///< ... in a second fit in which it may be; the rest is without.
  CalibrationVerdict verdict = CalibrationVerdict::kPrior;
  std::string reason;  ///< Why it is not ESTIMATED.
  struct Block {
    double time_s = 0.0;  ///< From the first pair.
    Eigen::Vector2d mean_en = Eigen::Vector2d::Zero();
  };
  std::vector<Block> blocks;  ///< Means of one second each, for plots.
};

/// Stage B for one sender, by Ceres. ESTIMATED: enough pairs, long and diverse enough, and off like
/// a receiver is; WEAK: latency and bias known together only; PRIOR: too little; AT_BOUND: as late
/// as a sender may be, and known no better; REJECTED: off as no receiver is (too far, drifting,
/// wandering too much, too late, turned about the ego): quarantine.
/// @param pairs of this sender, in order of time.
/// @param consider_m what stage A's own uncertainty adds to every place alike, 1 sigma per axis at
///        range 0, and consider_rad per range: held, never estimated from claims of senders.
RemoteSolution SolveRemote(SenderId sender, const std::vector<RemotePair>& pairs, double consider_m,
                           double consider_rad, const RemoteRules& rules);

/// All senders, then leave-one-out on what they have in common: with three ESTIMATED or more,
/// a sender farther from the mean of the others than honest receivers' spread allows is REJECTED.
std::vector<RemoteSolution> SolveRemotes(const std::vector<RemotePair>& pairs, double consider_m,
                                         double consider_rad, const RemoteRules& rules);

}  // namespace v2vouch
