// SPDX-License-Identifier: Apache-2.0
#include "sim/report/birds_eye.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "sim/metrics/placing.h"
#include "sim/plot/svg.h"
#include "sim/report/picture_labels.h"

namespace v2vouch::evaluation {
namespace {

const std::string kTruthStyle =
    std::string("fill=\"#ffffff\" stroke=\"") + colour::kInk + "\" stroke-width=\"1\"";
const std::string kHiddenStyle = std::string("fill=\"") + colour::kHidden + "\" stroke=\"" +
                                 colour::kAlarm +
                                 "\" stroke-width=\"1.2\" stroke-dasharray=\"3 2\"";
const std::string kOutOfViewStyle = std::string("fill=\"") + colour::kOutOfView + "\" stroke=\"" +
                                    colour::kMuted +
                                    "\" stroke-width=\"1.2\" stroke-dasharray=\"3 2\"";

std::vector<Eigen::Vector2d> Corners(const Eigen::Vector2d& centre, double yaw_rad, double length_m,
                                     double width_m) {
  const Eigen::Vector2d along =
      0.5 * length_m * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
  const Eigen::Vector2d across =
      0.5 * width_m * Eigen::Vector2d(-std::sin(yaw_rad), std::cos(yaw_rad));
  return {centre + along + across, centre - along + across, centre - along - across,
          centre + along - across};
}

/// World points to picture points, ego's heading up.
class Window {
 public:
  Window(const PlanarMotion& ego, const View& view)
      : ego_(ego), view_(view), scale_(kWidth / (2.0 * view.aside_m)) {}

  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] double height() const { return (view_.ahead_m + view_.behind_m) * scale_; }
  [[nodiscard]] Eigen::Vector2d FromBody(double x_m, double y_m) const {
    return {(view_.aside_m - y_m) * scale_, kTitle + (view_.ahead_m - x_m) * scale_};
  }
  [[nodiscard]] Eigen::Vector2d operator()(const Eigen::Vector2d& p_W) const {
    const Eigen::Vector2d d = p_W - ego_.position();
    const double c = std::cos(ego_.yaw_rad);
    const double s = std::sin(ego_.yaw_rad);
    return FromBody(c * d.x() + s * d.y(), -s * d.x() + c * d.y());
  }
  [[nodiscard]] std::vector<Eigen::Vector2d> operator()(std::vector<Eigen::Vector2d> points) const {
    for (auto& p : points) p = (*this)(p);
    return points;
  }

 private:
  PlanarMotion ego_;
  View view_;
  double scale_;
};

std::vector<Eigen::Vector2d> Ellipse(const Eigen::Vector2d& centre, const Eigen::Matrix2d& P) {
  constexpr int kPoints = 36;
  constexpr double kSigmas = 2.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(P);
  std::vector<Eigen::Vector2d> points;
  for (int k = 0; k < kPoints; ++k) {
    const double a = 2.0 * kPi * k / kPoints;
    const Eigen::Vector2d r = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    points.push_back(centre + kSigmas * axes.eigenvectors() *
                                  Eigen::Vector2d(r.x() * std::cos(a), r.y() * std::sin(a)));
  }
  return points;
}

std::string Stroke(const char* colour, const char* width, const char* more = "") {
  return std::string("fill=\"none\" stroke=\"") + colour + "\" stroke-width=\"" + width + "\" " +
         more;
}

void DrawGround(Svg& svg, const Evaluation& evaluation, const Window& window) {
  for (const auto& outline : evaluation.log.specs.buildings) {
    svg.Polygon(window(outline), "fill=\"#dfe3e8\" stroke=\"#c3c9d1\"");
  }
  for (const double ring_m : {25.0, 50.0, 75.0, 100.0}) {
    const Eigen::Vector2d ego = window.FromBody(0.0, 0.0);
    svg.Circle(ego.x(), ego.y(), ring_m * window.scale(),
               "fill=\"none\" stroke=\"#cfd5dc\" stroke-dasharray=\"1 3\"");
    const Eigen::Vector2d label = window.FromBody(ring_m, 0.0);
    if (label.y() < kTitle + 4.0) continue;  // Its letters would be cut.
    svg.Text(label.x() + 3.0, label.y() + 10.0, Number(ring_m) + " m", "class=\"ring\"");
  }
}

void DrawTruth(Svg& svg, const Evaluation& evaluation, const Window& window, Timestamp t) {
  for (std::size_t o = 0; o < evaluation.log.truth.objects.size(); ++o) {
    const TruthObject& object = evaluation.log.truth.objects[o];
    const auto motion = object.motion.At(t);
    if (!motion) continue;
    const auto X_WB = evaluation.log.truth.EgoPose(t);
    const Sighting sighting =
        X_WB ? TrueSighting(*object.motion.InForce(t), *motion, *X_WB, evaluation.log.specs)
             : Sighting::kVisible;
    const auto box =
        window(Corners(motion->position(), motion->yaw_rad, object.length_m, object.width_m));
    svg.Polygon(box, sighting == Sighting::kVisible  ? kTruthStyle
                     : sighting == Sighting::kHidden ? kHiddenStyle
                                                     : kOutOfViewStyle);
    // A bar across the bonnet shows where it is heading.
    const Eigen::Vector2d front = 0.5 * (box[0] + box[3]);
    const Eigen::Vector2d middle = window(motion->position());
    const Eigen::Vector2d tip = middle + 0.55 * (front - middle);
    svg.Polygon({box[0], box[3], tip},
                std::string("fill=\"") +
                    (sighting == Sighting::kHidden ? colour::kAlarm : colour::kInk) +
                    "\" fill-opacity=\"0.55\"");
  }
}

/// Names of the vehicles, drawn last so that nothing covers them; the critical one's first, as it
/// has the best place.
void DrawNames(Svg& svg, const Evaluation& evaluation, const Window& window, Timestamp t,
               std::optional<std::size_t> critical, Labels& labels) {
  std::vector<std::pair<std::size_t, Area>> named;
  for (std::size_t o = 0; o < evaluation.log.truth.objects.size(); ++o) {
    const TruthObject& object = evaluation.log.truth.objects[o];
    const auto motion = object.motion.At(t);
    if (!motion || !object.is_vehicle()) continue;
    const Area area = AreaOf(
        window(Corners(motion->position(), motion->yaw_rad, object.length_m, object.width_m)));
    if (area.right < 0.0 || area.left > kWidth || area.bottom < kTitle ||
        area.top > kTitle + window.height()) {
      continue;
    }
    labels.Avoid(area);
    // A name at the edge, of a vehicle that is hardly in the picture, would stand for nothing.
    const double x = (area.left + area.right) / 2, y = (area.top + area.bottom) / 2;
    if (x < 0.0 || x > kWidth || y < kTitle || y > kTitle + window.height()) continue;
    named.emplace_back(o, area);
  }
  const auto draw = [&](const std::pair<std::size_t, Area>& entry, bool is_critical) {
    const TruthObject& object = evaluation.log.truth.objects[entry.first];
    labels.Draw(svg, entry.second, std::to_string(object.id) + (object.has_v2v ? " V2V" : ""),
                is_critical ? "id critical" : "id", is_critical ? 7.6 : 6.4);
  };
  for (const auto& entry : named) {
    if (critical && entry.first == *critical) draw(entry, true);
  }
  for (const auto& entry : named) {
    if (!critical || entry.first != *critical) draw(entry, false);
  }
}

void DrawList(Svg& svg, const Evaluation& evaluation, const Window& window, Timestamp t,
              ListKind kind) {
  const auto tracks =
      PlaceTracks(evaluation.log, NewestBy(evaluation.log.lists[Index(kind)], t), kind, t);
  for (const PlacedTrack& placed : tracks) {
    const Eigen::Vector2d p_W = placed.motion_W.position();
    const Eigen::Vector2d p = window(p_W);
    const bool has_covariance = placed.covariance_W.allFinite();
    if (kind == ListKind::kV2v) {
      svg.Line(p.x() - 4.0, p.y() - 4.0, p.x() + 4.0, p.y() + 4.0, Stroke(colour::kV2v, "1.8"));
      svg.Line(p.x() - 4.0, p.y() + 4.0, p.x() + 4.0, p.y() - 4.0, Stroke(colour::kV2v, "1.8"));
      if (has_covariance) {
        svg.Polygon(window(Ellipse(p_W, placed.covariance_W)),
                    Stroke(colour::kV2v, "0.8", "stroke-dasharray=\"2 2\""));
      }
      continue;
    }
    const bool is_local = kind == ListKind::kLocal;
    const char* shade = is_local ? colour::kLocal : colour::kPriority;
    // PRIORITY is drawn a little larger, so that both outlines show where they agree.
    const double margin_m = is_local ? 0.0 : 0.7;
    svg.Polygon(window(Corners(p_W, placed.motion_W.yaw_rad, placed.track->length_m + margin_m,
                               placed.track->width_m + margin_m)),
                Stroke(shade, is_local ? "1.6" : "2"));
    if (has_covariance) {
      svg.Polygon(window(Ellipse(p_W, placed.covariance_W)),
                  std::string("fill=\"") + shade + "\" fill-opacity=\"0.18\" stroke=\"" + shade +
                      "\" stroke-width=\"0.8\"");
    }
  }
}

// What liars claimed within the last second, the newest of each device.
void DrawLies(Svg& svg, const RunLog& liars, const Window& window, Timestamp t, Labels& labels) {
  std::map<std::int64_t, const BsmTruth*> newest;
  for (const BsmTruth& bsm : liars.bsm_truths) {
    const double age_s = ToSeconds(t - bsm.stamp);
    if (bsm.is_attack && age_s >= -0.05 && age_s < 1.0) newest[bsm.device] = &bsm;
  }
  for (const auto& [device, bsm] : newest) {
    const Eigen::Vector2d p = window(bsm->claimed.p_W);
    const std::string style = Stroke(colour::kAlarm, "3");
    const auto box = window(Corners(bsm->claimed.p_W, bsm->claimed.yaw_rad, bsm->claimed.length_m,
                                    bsm->claimed.width_m));
    svg.Polygon(box, Stroke(colour::kAlarm, "1.6", "stroke-dasharray=\"2 2\""));
    svg.Line(p.x() - 6.0, p.y() - 6.0, p.x() + 6.0, p.y() + 6.0, style);
    svg.Line(p.x() - 6.0, p.y() + 6.0, p.x() + 6.0, p.y() - 6.0, style);
    const Area area = AreaOf(box);
    labels.Avoid(area);
    if (area.right > 0.0 && area.left < kWidth && area.bottom > kTitle &&
        area.top < kTitle + window.height()) {
      labels.Draw(svg, area, "false claim", "id critical", 7.4);
    }
  }
}

}  // namespace

View ChooseView(const Evaluation& evaluation, const std::vector<Moment>& moments,
                std::optional<std::size_t> critical) {
  View view;
  if (!critical) return view;
  const Truth& truth = evaluation.log.truth;
  for (const Moment& moment : moments) {
    const Timestamp t = evaluation.grid[moment.instant];
    const auto motion = truth.objects[*critical].motion.At(t);
    const auto X_WB = truth.EgoPose(t);
    if (!motion || !X_WB) continue;
    const Point<Body> p = X_WB->Inverse() * Point<World>{motion->x_m, motion->y_m};
    constexpr double kMargin_m = 10.0;
    view.ahead_m = std::clamp(p.x_m + kMargin_m, view.ahead_m, 110.0);
    view.behind_m = std::clamp(kMargin_m - p.x_m, view.behind_m, 70.0);
    view.aside_m = std::clamp(std::abs(p.y_m) + kMargin_m, view.aside_m, 80.0);
  }
  return view;
}

std::string BirdsEye(const Evaluation& evaluation, const Moment& moment, const View& view,
                     std::optional<std::size_t> critical, const std::string& id,
                     const RunLog* liars) {
  const Timestamp t = evaluation.grid[moment.instant];
  const auto ego = evaluation.log.truth.ego.At(t);
  if (!ego) return "";
  const Window window(*ego, view);
  Svg svg(kWidth, window.height() + kTitle);
  svg.Text(2.0, 15.0, Number(moment.t_s, 2) + " s: " + moment.title, "class=\"caption\"");
  svg.Rect(0.0, kTitle, kWidth, window.height(), "fill=\"#f7f8fa\"");
  svg.OpenClip("view-" + id, 0.0, kTitle, kWidth, window.height());
  DrawGround(svg, evaluation, window);
  DrawTruth(svg, evaluation, window, t);
  const SceneSpecs& specs = evaluation.log.specs;
  const Eigen::Vector2d centre = ego->position() + specs.ego_centre_x_m * ego->direction();
  svg.Polygon(window(Corners(centre, ego->yaw_rad, specs.ego_length_m, specs.ego_width_m)),
              std::string("fill=\"") + colour::kInk + "\"");
  for (const ListKind kind : {ListKind::kV2v, ListKind::kLocal, ListKind::kPriority}) {
    DrawList(svg, evaluation, window, t, kind);
  }
  Labels labels(window.height());
  if (liars != nullptr) DrawLies(svg, *liars, window, t, labels);
  DrawNames(svg, evaluation, window, t, critical, labels);
  svg.Close();
  svg.Rect(0.5, kTitle + 0.5, kWidth - 1.0, window.height() - 1.0, Stroke("#c3c9d1", "1"));
  return svg.Finish();
}

std::string BirdsEyeLegend() {
  Svg svg(1060.0, 22.0);
  double x = 2.0;
  const auto text = [&](const char* label, double width) {
    svg.Text(x + 26.0, 15.0, label, "class=\"legend\"");
    x += width;
  };
  svg.Rect(x, 6.0, 20.0, 10.0, std::string("fill=\"") + colour::kInk + "\"");
  text("ego", 70.0);
  svg.Rect(x, 6.0, 20.0, 10.0, kTruthStyle);
  text("true vehicle", 124.0);
  svg.Rect(x, 6.0, 20.0, 10.0, kHiddenStyle);
  text("hidden", 90.0);
  svg.Rect(x, 6.0, 20.0, 10.0, kOutOfViewStyle);
  text("out of view", 116.0);
  svg.Rect(x, 6.0, 20.0, 10.0, Stroke(colour::kLocal, "1.6"));
  text("LOCAL track", 126.0);
  svg.Rect(x, 6.0, 20.0, 10.0, Stroke(colour::kPriority, "2"));
  text("PRIORITY track", 142.0);
  svg.Line(x + 6.0, 7.0, x + 14.0, 15.0, Stroke(colour::kV2v, "1.8"));
  svg.Line(x + 6.0, 15.0, x + 14.0, 7.0, Stroke(colour::kV2v, "1.8"));
  text("V2V claim", 108.0);
  svg.Circle(x + 10.0, 11.0, 7.0, Stroke(colour::kMuted, "1"));
  text("2-sigma ellipse", 138.0);
  svg.Rect(x, 6.0, 20.0, 10.0, "fill=\"#dfe3e8\" stroke=\"#c3c9d1\"");
  text("building", 60.0);
  return svg.Finish();
}

}  // namespace v2vouch::evaluation
