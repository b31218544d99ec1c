// The only file that knows cairo.
#include "host_sim/render/picture/canvas.h"

#include <cairo/cairo.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/grey_image.h"

/// fontconfig keeps what it knows about the system's fonts until the process ends (the same few
/// hundred bytes for one canvas or fifty). The leak checker of -fsanitize=address asks here.
extern "C" __attribute__((visibility("default"))) const char* __lsan_default_suppressions() {
  return "leak:libfontconfig";
}

namespace screed {

struct Canvas::Cairo {
  cairo_surface_t* surface = nullptr;
  cairo_t* context = nullptr;

  Cairo() = default;
  Cairo(const Cairo&) = delete;
  Cairo& operator=(const Cairo&) = delete;
  ~Cairo() {
    cairo_destroy(context);  // both accept null
    cairo_surface_destroy(surface);
  }

  void use(Color color) const {
    cairo_set_source_rgba(context, color.red, color.green, color.blue, color.alpha);
  }
  void trace(std::span<const Pixel> points) const {
    cairo_new_path(context);
    for (const Pixel& point : points) cairo_line_to(context, point.x, point.y);
  }
  void trace(const PixelBox& box) const {
    cairo_new_path(context);
    cairo_rectangle(context, box.left, box.top, box.width, box.height);
  }
  void stroke(double width_px, Color color) const {
    use(color);
    cairo_set_line_width(context, width_px);
    cairo_stroke(context);
  }
  void fill(Color color) const {
    use(color);
    cairo_fill(context);
  }
  std::span<uint32_t> pixels() const {
    cairo_surface_flush(surface);
    // Rows of 32-bit pixels are never padded.
    return {reinterpret_cast<uint32_t*>(cairo_image_surface_get_data(surface)),
            static_cast<size_t>(cairo_image_surface_get_width(surface)) *
                static_cast<size_t>(cairo_image_surface_get_height(surface))};
  }
  void choose_font(const TextStyle& style) const {
    cairo_select_font_face(context, "sans", CAIRO_FONT_SLANT_NORMAL,
                           style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context, style.size_px);
  }
};

void Canvas::CairoDeleter::operator()(Cairo* cairo) const {
  delete cairo;
}

Canvas::Canvas(int width_px, int height_px, Color background)
    : width_(width_px), height_(height_px), cairo_(new Cairo) {
  cairo_->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px);
  cairo_->context = cairo_create(cairo_->surface);
  if (cairo_status(cairo_->context) != CAIRO_STATUS_SUCCESS) {
    throw RunError("picture of " + std::to_string(width_px) + " x " + std::to_string(height_px) +
                   " pixels: " + cairo_status_to_string(cairo_status(cairo_->context)));
  }
  cairo_t* context = cairo_->context;
  cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(context, CAIRO_LINE_CAP_ROUND);
  // Unhinted grey text, so that a user's font settings do not change the picture.
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context, options);
  cairo_font_options_destroy(options);
  cairo_->use(background);
  cairo_paint(context);
}

void Canvas::line(std::span<const Pixel> points, double width_px, Color color) {
  cairo_->trace(points);
  cairo_->stroke(width_px, color);
}

void Canvas::polygon(std::span<const Pixel> corners, Color fill) {
  cairo_->trace(corners);
  cairo_->fill(fill);
}

void Canvas::polygon_outline(std::span<const Pixel> corners, double width_px, Color color) {
  cairo_->trace(corners);
  cairo_close_path(cairo_->context);
  cairo_->stroke(width_px, color);
}

void Canvas::circle(Pixel center, double radius_px, Color fill) {
  cairo_new_path(cairo_->context);
  cairo_arc(cairo_->context, center.x, center.y, radius_px, 0.0, 2.0 * std::numbers::pi);
  cairo_->fill(fill);
}

void Canvas::rectangle(const PixelBox& box, Color fill) {
  cairo_->trace(box);
  cairo_->fill(fill);
}

void Canvas::rectangle_outline(const PixelBox& box, double width_px, Color color) {
  cairo_->trace(box);
  cairo_->stroke(width_px, color);
}

void Canvas::text(Pixel anchor, const std::string& words, const TextStyle& style) {
  const double width = text_width(words, style);
  const double before = style.align == TextAlign::kLeft     ? 0.0
                        : style.align == TextAlign::kCenter ? 0.5 * width
                                                            : width;
  cairo_t* context = cairo_->context;
  cairo_save(context);
  cairo_translate(context, anchor.x, anchor.y);
  if (style.upwards) cairo_rotate(context, -0.5 * std::numbers::pi);
  cairo_move_to(context, -before, 0.0);
  cairo_->use(style.color);
  cairo_show_text(context, words.c_str());
  cairo_restore(context);
}

double Canvas::text_width(const std::string& words, const TextStyle& style) {
  cairo_->choose_font(style);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_->context, words.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::set_row(int x, int y, std::span<const uint32_t> colors) {
  std::copy(colors.begin(), colors.end(), pixels().data() + static_cast<ptrdiff_t>(y) * width_ + x);
  release_pixels();
}

std::span<uint32_t> Canvas::pixels() {
  return cairo_->pixels();
}

void Canvas::release_pixels() {
  cairo_surface_mark_dirty(cairo_->surface);
}

void Canvas::clip(const PixelBox& box) {
  cairo_->trace(box);
  cairo_clip(cairo_->context);
}

void Canvas::unclip() {
  cairo_reset_clip(cairo_->context);
}

std::vector<uint8_t> Canvas::rgb() const {
  const cairo_status_t status = cairo_status(cairo_->context);
  if (status != CAIRO_STATUS_SUCCESS) {
    throw RunError(std::string("picture cannot be drawn: ") + cairo_status_to_string(status) +
                   " (is a font installed, for instance fonts-dejavu-core?)");
  }
  return rgb_bytes(cairo_->pixels());
}

void Canvas::write_png(const std::filesystem::path& path) const {
  write_rgb_png(path, width_, height_, rgb());
}

}  // namespace screed
