// PNG files by librsvg and cairo.
#include "host_sim/render/chart/svg_png.h"

#include <cairo.h>
#include <librsvg/rsvg.h>

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
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

cairo_status_t append(void* bytes, const unsigned char* more, unsigned int size) {
  auto& all = *static_cast<std::vector<std::uint8_t>*>(bytes);
  all.insert(all.end(), more, more + size);
  return CAIRO_STATUS_SUCCESS;
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

std::vector<std::uint8_t> rgb_png(int width, int height, std::span<const std::uint8_t> rgb) {
  const std::unique_ptr<cairo_surface_t, Release> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  unsigned char* const pixels = cairo_image_surface_get_data(surface.get());
  if (pixels == nullptr) throw RunError("a picture has no memory");
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const std::uint8_t* const from = &rgb[3 * (static_cast<std::size_t>(row) * width + column)];
      const std::uint32_t color =
          std::uint32_t{from[0]} << 16U | std::uint32_t{from[1]} << 8U | std::uint32_t{from[2]};
      std::memcpy(pixels + static_cast<std::ptrdiff_t>(row) * stride + std::ptrdiff_t{4} * column,
                  &color, sizeof color);
    }
  }
  cairo_surface_mark_dirty(surface.get());
  std::vector<std::uint8_t> png;
  if (cairo_surface_write_to_png_stream(surface.get(), append, &png) != CAIRO_STATUS_SUCCESS) {
    throw RunError("a picture cannot be encoded");
  }
  return png;
}

}  // namespace screed
