// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calibration/extrinsics/drive_problem.h"

namespace v2vouch {

/// What is left of the measurements at the solution, small enough to draw: what a mean and a noise
/// cannot show (a bumper that bends azimuth, a range scale, a lens) shows here.
struct ResidualPictures {
  struct Bin {
    double at = 0.0;
    double mean = 0.0;
    double std = 0.0;  ///< Of one residual.
    int count = 0;
  };
  struct Radar {
    std::string name;
    std::vector<Bin>
        doppler_by_azimuth;           ///< Degrees -> m/s, range rate minus the standing world's.
    std::vector<Bin> range_by_range;  ///< m -> m, measured minus solved, of moving targets.
  };
  struct Pixel {
    double u_px, v_px;    ///< Where the box's foot was.
    double du_px, dv_px;  ///< Measured minus solved, nod left out.
  };
  struct Camera {
    std::string name;
    int width_px = 0;
    int height_px = 0;
    std::vector<Pixel> pixels;  ///< Evenly thinned to 1500 at most.
  };
  std::vector<Radar> radars;
  std::vector<Camera> cameras;
};

ResidualPictures DrawResiduals(const DriveData& data, const DriveProblem& problem,
                               const MountingParameters& parameters);

}  // namespace v2vouch
