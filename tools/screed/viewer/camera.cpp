// Fitting and zooming.
#include "tools/screed/viewer/camera.h"

namespace screed::viewer {

void Camera::fit(const MapRectangle& ground) {
  constexpr double kFilled = 0.94;
  const double width = ground.x_max - ground.x_min;
  const double depth = ground.y_max - ground.y_min;
  scale_ =
      std::clamp(kFilled * std::min(box_.width / width, box_.height / depth), kMinScale, kMaxScale);
  look_at(0.5 * (ground.x_min + ground.x_max), 0.5 * (ground.y_min + ground.y_max));
}

void Camera::zoom(double factor, Pixel fixed) {
  const double x = x_at(fixed.x);
  const double y = y_at(fixed.y);
  scale_ = std::clamp(scale_ * factor, kMinScale, kMaxScale);
  x_ = x - (fixed.x - middle().x) / scale_;
  y_ = y + (fixed.y - middle().y) / scale_;
}

}  // namespace screed::viewer
