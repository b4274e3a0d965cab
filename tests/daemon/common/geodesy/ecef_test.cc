// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/geodesy/ecef.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

constexpr double kMicrometre = 1e-6;

Wgs84 FromDegreesAt(double latitude_deg, double longitude_deg, double height_m) {
  return {FromDegrees(latitude_deg), FromDegrees(longitude_deg), height_m};
}

Eigen::Vector3d ReferenceEcef(const Wgs84& at) {
  Eigen::Vector3d p;
  GeographicLib::Geocentric::WGS84().Forward(
      ToDegrees(at.latitude_rad), ToDegrees(at.longitude_rad), at.height_m, p.x(), p.y(), p.z());
  return p;
}

// The whole globe: a grid that holds equator, poles and date line, their neighbourhoods, and
// random places.
std::vector<Wgs84> Globe() {
  std::vector<Wgs84> places;
  for (const double height : {-100.0, 0.0, 123.4, 10000.0}) {
    for (double latitude = -90.0; latitude <= 90.0; latitude += 7.5) {
      for (double longitude = -165.0; longitude <= 180.0; longitude += 15.0) {
        places.push_back(FromDegreesAt(latitude, longitude, height));
      }
    }
    for (const double nudge : {1e-9, 1e-7, 1e-5, 1e-3}) {
      for (const double longitude : {-180.0 + nudge, 180.0 - nudge, -nudge, nudge}) {
        for (const double latitude : {-90.0 + nudge, 90.0 - nudge, -nudge, nudge, 47.1}) {
          places.push_back(FromDegreesAt(latitude, longitude, height));
        }
      }
    }
  }
  Random random(20250301);
  for (int i = 0; i < 5000; ++i) {
    places.push_back(FromDegreesAt(ToDegrees(std::asin(random.Uniform(-1.0, 1.0))),
                                   random.Uniform(-180.0, 180.0), random.Uniform(-100.0, 10000.0)));
  }
  return places;
}

TEST(ToEcef, AgreesWithGeographicLibOverTheGlobeToOneMicrometre) {
  double worst = 0.0;
  for (const Wgs84& place : Globe()) {
    const double error = (ToEcef(place).p_E - ReferenceEcef(place)).norm();
    worst = std::max(worst, error);
    ASSERT_LT(error, kMicrometre) << ToDegrees(place.latitude_rad) << ' '
                                  << ToDegrees(place.longitude_rad) << ' ' << place.height_m;
  }
  RecordProperty("worst_micrometre", std::to_string(worst / kMicrometre));
}

TEST(ToWgs84, AgreesWithGeographicLibOverTheGlobeToOneMicrometre) {
  double worst = 0.0;
  for (const Wgs84& place : Globe()) {
    const Eigen::Vector3d p_E = ReferenceEcef(place);
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double height_m = 0.0;
    GeographicLib::Geocentric::WGS84().Reverse(p_E.x(), p_E.y(), p_E.z(), latitude_deg,
                                               longitude_deg, height_m);
    const Wgs84 ours = ToWgs84({p_E});
    // Angles as distances over ground; a longitude counts for what it is worth at its latitude.
    const double radius = p_E.norm();
    const double north = radius * (ours.latitude_rad - FromDegrees(latitude_deg));
    const double east = std::hypot(p_E.x(), p_E.y()) *
                        AngleDifference(ours.longitude_rad, FromDegrees(longitude_deg));
    const double error = std::hypot(north, east, ours.height_m - height_m);
    worst = std::max(worst, error);
    ASSERT_LT(error, kMicrometre) << latitude_deg << ' ' << longitude_deg << ' ' << height_m;
    ASSERT_GT(ours.longitude_rad, -kPi);
    ASSERT_LE(ours.longitude_rad, kPi);
  }
  RecordProperty("worst_micrometre", std::to_string(worst / kMicrometre));
}

TEST(ToWgs84Property, UndoesToEcefToOneMicrometre) {
  double worst = 0.0;
  for (const Wgs84& place : Globe()) {
    const EcefPoint there = ToEcef(place);
    const Wgs84 back = ToWgs84(there);
    const double error = (ToEcef(back).p_E - there.p_E).norm();
    worst = std::max(worst, error);
    ASSERT_LT(error, kMicrometre);
    ASSERT_NEAR(back.height_m, place.height_m, kMicrometre);
    ASSERT_NEAR(back.latitude_rad, place.latitude_rad, 1e-13);
  }
  RecordProperty("worst_micrometre", std::to_string(worst / kMicrometre));
}

TEST(ToWgs84Property, HoldsFromDeepUndergroundToOrbit) {
  Random random(77);
  for (int i = 0; i < 2000; ++i) {
    const Wgs84 place = FromDegreesAt(random.Uniform(-90.0, 90.0), random.Uniform(-180.0, 180.0),
                                      random.Uniform(-3.0e6, 4.0e7));
    const EcefPoint there = ToEcef(place);
    EXPECT_LT((ToEcef(ToWgs84(there)).p_E - there.p_E).norm(), kMicrometre) << place.height_m;
  }
}

TEST(ToWgs84, PolesHaveTheirLatitudeAndALongitudeOfZero) {
  constexpr double kPolarRadius_m = 6356752.314245179;  // WGS-84 b = a (1 - f).
  const Wgs84 north = ToWgs84({{0.0, 0.0, kPolarRadius_m + 5.0}});
  EXPECT_DOUBLE_EQ(north.latitude_rad, kPi / 2.0);
  EXPECT_EQ(north.longitude_rad, 0.0);
  EXPECT_NEAR(north.height_m, 5.0, kMicrometre);
  const Wgs84 south = ToWgs84({{0.0, 0.0, -kPolarRadius_m + 5.0}});
  EXPECT_DOUBLE_EQ(south.latitude_rad, -kPi / 2.0);
  EXPECT_NEAR(south.height_m, -5.0, kMicrometre);
}

TEST(ToWgs84, TheDateLineIsPlus180Degrees) {
  EXPECT_EQ(ToWgs84({{-6378137.0, 0.0, 0.0}}).longitude_rad, kPi);
  EXPECT_EQ(ToWgs84({{-6378137.0, -0.0, 0.0}}).longitude_rad, kPi);
}

TEST(ToWgs84, TheCentreOfTheEarthGivesFiniteNumbers) {
  const Wgs84 centre = ToWgs84({Eigen::Vector3d::Zero()});
  EXPECT_TRUE(std::isfinite(centre.latitude_rad));
  EXPECT_TRUE(std::isfinite(centre.longitude_rad));
  EXPECT_TRUE(std::isfinite(centre.height_m));
}

TEST(LocalPlane, AgreesWithGeographicLibToOneMicrometre) {
  Random random(4);
  double worst = 0.0;
  for (const Wgs84& origin : Globe()) {
    const LocalPlane plane(origin);
    const GeographicLib::LocalCartesian reference(ToDegrees(origin.latitude_rad),
                                                  ToDegrees(origin.longitude_rad), origin.height_m);
    for (int i = 0; i < 3; ++i) {
      // Up to 10 km away, also over a pole or the date line.
      const LocalPoint near{
          {random.Uniform(-1e4, 1e4), random.Uniform(-1e4, 1e4), random.Uniform(-200.0, 200.0)}};
      const Wgs84 place = plane.ToGeodetic(near);
      Eigen::Vector3d theirs;
      reference.Forward(ToDegrees(place.latitude_rad), ToDegrees(place.longitude_rad),
                        place.height_m, theirs.x(), theirs.y(), theirs.z());
      const double error = std::max((plane.ToLocal(place).p_L - theirs).norm(),
                                    (plane.ToLocal(place).p_L - near.p_L).norm());
      worst = std::max(worst, error);
      ASSERT_LT(error, kMicrometre)
          << ToDegrees(origin.latitude_rad) << ' ' << ToDegrees(origin.longitude_rad);
    }
  }
  RecordProperty("worst_micrometre", std::to_string(worst / kMicrometre));
}

TEST(LocalPlane, EastNorthUpPointWhereTheyShould) {
  const Wgs84 origin = FromDegreesAt(48.0, 11.0, 500.0);
  const LocalPlane plane(origin);
  const Eigen::Vector3d east = plane.ToLocal(FromDegreesAt(48.0, 11.001, 500.0)).p_L;
  EXPECT_GT(east.x(), 70.0);
  EXPECT_NEAR(east.y(), 0.0, 0.01);
  const Eigen::Vector3d north = plane.ToLocal(FromDegreesAt(48.001, 11.0, 500.0)).p_L;
  EXPECT_NEAR(north.x(), 0.0, kMicrometre);
  EXPECT_GT(north.y(), 110.0);
  const Eigen::Vector3d up = plane.ToLocal(FromDegreesAt(48.0, 11.0, 510.0)).p_L;
  EXPECT_NEAR((up - Eigen::Vector3d(0.0, 0.0, 10.0)).norm(), 0.0, kMicrometre);
}

TEST(LocalPlane, TheTwinOfLongitude180IsTheSamePlane) {
  const LocalPlane west(FromDegreesAt(-17.0, -180.0, 3.0));
  const LocalPlane east(FromDegreesAt(-17.0, 180.0, 3.0));
  const Wgs84 place = FromDegreesAt(-17.002, 179.999, 8.0);
  EXPECT_LT((west.ToLocal(place).p_L - east.ToLocal(place).p_L).norm(), kMicrometre);
}

TEST(LocalPlane, GammaPointsTheXAxisThatFarLeftOfEast) {
  const Wgs84 origin = FromDegreesAt(40.0, -83.0, 250.0);
  const LocalPlane plain(origin);
  Random random(9);
  for (int i = 0; i < 200; ++i) {
    const double gamma = random.Uniform(-kPi, kPi);
    const LocalPlane turned(origin, gamma);
    // A point straight along the direction gamma from east lies on the turned x axis.
    const Wgs84 ahead =
        plain.ToGeodetic(LocalPoint{{100.0 * std::cos(gamma), 100.0 * std::sin(gamma), 2.0}});
    EXPECT_LT((turned.ToLocal(ahead).p_L - Eigen::Vector3d(100.0, 0.0, 2.0)).norm(), kMicrometre);
    // And the general law: turned = C_z(gamma) * plain, against Eigen's own rotation.
    const Wgs84 anywhere = FromDegreesAt(40.0 + random.Uniform(-0.05, 0.05),
                                         -83.0 + random.Uniform(-0.05, 0.05), 260.0);
    const Eigen::Vector3d expected =
        Eigen::AngleAxisd(-gamma, Eigen::Vector3d::UnitZ()) * plain.ToLocal(anywhere).p_L;
    EXPECT_LT((turned.ToLocal(anywhere).p_L - expected).norm(), kMicrometre);
  }
}

TEST(LocalPlane, RotationIsTheThreeTurnsOfTheDataSheet) {
  Random random(10);
  for (int i = 0; i < 200; ++i) {
    const Wgs84 origin{random.Uniform(-kPi / 2.0, kPi / 2.0), random.Uniform(-kPi, kPi), 0.0};
    const double gamma = random.Uniform(-kPi, kPi);
    // Axes turned by t see directions turned by -t.
    const Eigen::Matrix3d expected =
        (Eigen::AngleAxisd(-gamma, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(-(kPi / 2.0 - origin.latitude_rad), Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(-(kPi / 2.0 + origin.longitude_rad), Eigen::Vector3d::UnitZ()))
            .toRotationMatrix();
    EXPECT_LT((LocalPlane(origin, gamma).R_LE() - expected).norm(), 1e-14);
  }
}

TEST(LocalPlaneProperty, RoundTripsAndKeepsDistances) {
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const LocalPlane plane(FromDegreesAt(random.Uniform(-90.0, 90.0), random.Uniform(-180.0, 180.0),
                                         random.Uniform(-100.0, 10000.0)),
                           random.Uniform(-kPi, kPi));
    const LocalPoint a{{random.Uniform(-2e4, 2e4), random.Uniform(-2e4, 2e4), 30.0}};
    const LocalPoint b{{random.Uniform(-2e4, 2e4), random.Uniform(-2e4, 2e4), -30.0}};
    EXPECT_LT((plane.ToLocal(plane.ToEcefPoint(a)).p_L - a.p_L).norm(), kMicrometre);
    EXPECT_LT((plane.ToLocal(plane.ToGeodetic(a)).p_L - a.p_L).norm(), kMicrometre);
    EXPECT_NEAR((plane.ToEcefPoint(a).p_E - plane.ToEcefPoint(b).p_E).norm(),
                (a.p_L - b.p_L).norm(), kMicrometre);
  }
}

TEST(HorizontalDistance, TakesTheHeightOut) {
  Random random(12);
  for (int i = 0; i < 500; ++i) {
    const LocalPlane plane(FromDegreesAt(random.Uniform(-90.0, 90.0), random.Uniform(-180.0, 180.0),
                                         random.Uniform(0.0, 3e3)));
    const double x = random.Uniform(-1000.0, 1000.0);
    const double y = random.Uniform(-1000.0, 1000.0);
    const Eigen::Vector3d from = plane.ToEcefPoint(LocalPoint{}).p_E;
    const Eigen::Vector3d to =
        plane.ToEcefPoint(LocalPoint{{x, y, random.Uniform(-3000.0, 3000.0)}}).p_E;
    EXPECT_NEAR(HorizontalDistance(from, to), std::hypot(x, y), 0.05);
  }
}

TEST(EastNorthUp, IsARightHandedRotationEverywhere) {
  for (const Wgs84& place : Globe()) {
    const Eigen::Matrix3d R = EastNorthUp(place);
    ASSERT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    ASSERT_NEAR(R.determinant(), 1.0, 1e-14);
  }
}

}  // namespace
}  // namespace v2vouch
