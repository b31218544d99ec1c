// SVG text to a PNG file, by librsvg and cairo.
#include "host_sim/render/picture/svg_png.h"

#include <cairo.h>
#include <librsvg/rsvg.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"

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

cairo_status_t put(void* stream, const unsigned char* bytes, unsigned int size) {
  const bool taken = std::fwrite(bytes, 1, size, static_cast<std::FILE*>(stream)) == size;
  return taken ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
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
  AtomicFile file(path);
  const cairo_status_t status =
      cairo_surface_write_to_png_stream(surface.get(), put, file.stream());
  if (status != CAIRO_STATUS_SUCCESS) {
    throw RunError(path.string() + ": cannot be written: " + cairo_status_to_string(status));
  }
  file.commit();
}

}  // namespace screed
