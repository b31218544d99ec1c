// PNG files by librsvg and cairo.
#include "host_sim/render/chart/svg_png.h"

#include <cairo.h>
#include <librsvg/rsvg.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/grey_image.h"
#include "host_sim/render/picture/color_map.h"

namespace screed {
namespace {

struct Release {
  void operator()(RsvgHandle* it) const { g_object_unref(it); }
  void operator()(cairo_surface_t* it) const { cairo_surface_destroy(it); }
  void operator()(cairo_t* it) const { cairo_destroy(it); }
};

[[noreturn]] void fail(const std::filesystem::path& path, GError* error) {
  std::string what = path.string() + ": the picture cannot be drawn";
  if (error != nullptr) what += std::string(": ") + error->message;
  g_clear_error(&error);
  throw RunError(what);
}

}  // namespace

void write_svg_as_png(const std::filesystem::path& path, const std::string& svg, double scale) {
  GError* error = nullptr;
  const std::unique_ptr<RsvgHandle, Release> picture(
      rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), &error));
  if (picture == nullptr) fail(path, error);
  double width = 0.0;
  double height = 0.0;
  if (rsvg_handle_get_intrinsic_size_in_pixels(picture.get(), &width, &height) == 0) {
    throw RunError(path.string() + ": the picture has no size in pixels");
  }
  const RsvgRectangle all = {0.0, 0.0, std::ceil(width * scale), std::ceil(height * scale)};
  const std::unique_ptr<cairo_surface_t, Release> surface(cairo_image_surface_create(
      CAIRO_FORMAT_RGB24, static_cast<int>(all.width), static_cast<int>(all.height)));
  const std::unique_ptr<cairo_t, Release> cairo(cairo_create(surface.get()));
  cairo_set_source_rgb(cairo.get(), 1.0, 1.0, 1.0);
  cairo_paint(cairo.get());
  if (rsvg_handle_render_document(picture.get(), cairo.get(), &all, &error) == 0) {
    fail(path, error);
  }
  const cairo_status_t status = cairo_status(cairo.get());
  if (status != CAIRO_STATUS_SUCCESS) {
    throw RunError(path.string() +
                   ": the picture cannot be drawn: " + cairo_status_to_string(status));
  }
  cairo_surface_flush(surface.get());
  // Rows of 32-bit pixels are never padded.
  const std::span pixels(
      reinterpret_cast<const std::uint32_t*>(cairo_image_surface_get_data(surface.get())),
      static_cast<std::size_t>(all.width) * static_cast<std::size_t>(all.height));
  write_rgb_png(path, static_cast<int>(all.width), static_cast<int>(all.height), rgb_bytes(pixels));
}

}  // namespace screed
