// Where the eye is: which part of the ground lies on which part of the window.
#pragma once

#include <algorithm>

#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/map_frame.h"

namespace screed::viewer {

class Camera {
 public:
  static constexpr double kMinScale = 5.0;      ///< pixels a metre
  static constexpr double kMaxScale = 20000.0;  ///< a millimetre is 20 pixels

  /// The part of the window that shows the ground; its middle goes on showing the same place.
  void set_box(const PixelBox& box) { box_ = box; }
  const PixelBox& box() const { return box_; }

  /// Shows all of `ground`, with a small margin.
  void fit(const MapRectangle& ground);
  /// Looks at a place.
  void look_at(double x_m, double y_m) {
    x_ = x_m;
    y_ = y_m;
  }
  /// Zooms by `factor`; what lies under `fixed` stays there.
  void zoom(double factor, Pixel fixed);
  /// The ground follows a drag.
  void drag(double dx_px, double dy_px) {
    x_ -= dx_px / scale_;
    y_ += dy_px / scale_;
  }

  double scale() const { return scale_; }  ///< pixels a metre
  Pixel middle() const { return {box_.left + 0.5 * box_.width, box_.top + 0.5 * box_.height}; }
  Pixel to_pixel(double x_m, double y_m) const {
    return {middle().x + (x_m - x_) * scale_, middle().y - (y_m - y_) * scale_};
  }
  double x_at(double pixel_x) const { return x_ + (pixel_x - middle().x) / scale_; }
  double y_at(double pixel_y) const { return y_ - (pixel_y - middle().y) / scale_; }

 private:
  PixelBox box_{0.0, 0.0, 1.0, 1.0};
  double x_ = 0.0;
  double y_ = 0.0;
  double scale_ = 100.0;
};

}  // namespace screed::viewer
