// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// Pixel of the ground point (x, y, 0) of body frame B, through the mounting (x, y, z, yaw left,
/// pitch down, roll right side down; data/vehicle.h), the pinhole and OpenCV's distortion. `nod` is
/// the body's own pitch in this picture, down positive.
/// @return false for points less than half a metre ahead of the image plane.
template <class T>
bool ProjectGround(const CameraConfig& camera, const T* mounting, const T& x_B, const T& y_B,
                   const T& nod, T& u_px, T& v_px) {
  using std::cos;
  using std::sin;
  const T dx = x_B - mounting[0];
  const T dy = y_B - mounting[1];
  const T dz = -mounting[2];
  const T ahead = cos(mounting[3]) * dx + sin(mounting[3]) * dy;
  const T right = sin(mounting[3]) * dx - cos(mounting[3]) * dy;
  const T pitch = mounting[4] + nod;
  const T forward = cos(pitch) * ahead - sin(pitch) * dz;
  const T down = -(sin(pitch) * ahead + cos(pitch) * dz);
  if (!(forward > T(0.5))) return false;
  const T a = (cos(mounting[5]) * right + sin(mounting[5]) * down) / forward;
  const T b = (cos(mounting[5]) * down - sin(mounting[5]) * right) / forward;
  const auto k = [&](std::size_t i) {
    return i < camera.distortion.size() ? camera.distortion[i] : 0.0;
  };
  const T r2 = a * a + b * b;
  const T radial = T(1.0) + r2 * (T(k(0)) + r2 * (T(k(1)) + r2 * T(k(4))));
  u_px = T(camera.cx_px) +
         T(camera.fx_px) * (a * radial + T(2.0 * k(2)) * a * b + T(k(3)) * (r2 + T(2.0) * a * a));
  v_px = T(camera.cy_px) +
         T(camera.fy_px) * (b * radial + T(k(2)) * (r2 + T(2.0) * b * b) + T(2.0 * k(3)) * a * b);
  return true;
}

}  // namespace v2vouch
