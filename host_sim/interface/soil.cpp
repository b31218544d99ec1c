// The C interface of deformable soil: what comes from C is checked here, once; what is thrown ends
// here.
#include "host_sim/interface/screed/soil.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/vector.hpp>
#include <cmath>
#include <cstring>
#include <deque>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/state_bytes.h"
#include "host_sim/interface/checks.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/field_bytes.h"
#include "host_sim/physics/terrain/footprint.h"
#include "host_sim/physics/terrain/height_field.h"
#include "version.h"

namespace {

using namespace screed;  // of a file whose own names are C's
using namespace screed::interface;

struct Body {
  std::vector<screed_patch> patches;
  std::vector<Footprint> footprints;
  std::vector<ContactMemory> memories;
  std::vector<FootprintContact> contacts;
  BodyMemory memory;
};

}  // namespace

struct screed_soil : Handle {
  explicit screed_soil(SoilBed of) : bed(std::move(of)) {}

  SoilBed bed;
  std::deque<Body> bodies;     // footprints are known by their address
  bool in_step = false;        // bodies have pressed and the step has not ended
  std::vector<uint32_t> seen;  // revisions of the surface's tiles when changes were last asked for
};

namespace {

// What comes from C, checked.

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Eigen::Vector3d vector_from(const double* from, const char* what, double greatest,
                            const char* range) {
  Eigen::Vector3d vector = Eigen::Map<const Eigen::Vector3d>(from);
  for (const double part : vector) require(std::abs(part) <= greatest, what, part, range);
  return vector;
}

Eigen::Matrix3d matrix_from(const double* from, const char* what) {
  Eigen::Matrix3d matrix = Eigen::Map<const RowMajor>(from);
  for (const double part : matrix.reshaped())
    require(std::isfinite(part), what, part, "finite numbers");
  return matrix;
}

Eigen::Matrix3d rotation_from(const double* from) {
  constexpr double kError = 1e-6;
  Eigen::Matrix3d axes = matrix_from(from, "axes");
  const double error =
      (axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  require(error < kError && axes.determinant() > 0.0, "axes: error of the rotation", error,
          "below 1e-6, right-handed");
  return axes;
}

/// Zero stays zero.
Eigen::Matrix3d inverse_inertia_from(const double* from) {
  Eigen::Matrix3d inertia = matrix_from(from, "inertia");
  if (inertia.isZero(0.0)) return inertia;
  const Eigen::LLT<Eigen::Matrix3d> factors(inertia);
  if (factors.info() != Eigen::Success || !inertia.isApprox(inertia.transpose(), 1e-9)) {
    throw InputError("inertia: allowed: a symmetric matrix with positive moments, or all zero");
  }
  return factors.solve(Eigen::Matrix3d::Identity());
}

Footprint footprint_of(const screed_patch& patch) {
  const auto need = [&](int sizes) {
    for (int i = 0; i < sizes; ++i) {
      require(patch.size[i] >= 1e-4 && patch.size[i] <= 100.0, "size", patch.size[i],
              "0.0001 to 100 m");
    }
  };
  require(patch.friction >= 0.0, "friction", patch.friction, "0 or more");
  require(patch.adhesion >= 0.0 && patch.adhesion <= 1e6, "adhesion", patch.adhesion,
          "0 to 1000000 Pa");
  require(patch.lug_height >= 0.0 && patch.lug_height <= 0.1, "lug_height", patch.lug_height,
          "0 to 0.1 m");
  const double* size = patch.size;
  switch (patch.shape) {
    case SCREED_WHEEL:
      need(2);
      return Footprint::wheel(size[0], size[1]);
    case SCREED_TRACK:
      need(3);
      return Footprint::track(0.5 * size[2], size[0], size[1]);
    case SCREED_BOX:
      need(3);
      return Footprint::box(Eigen::Map<const Eigen::Vector3d>(size));
    case SCREED_DISC:
      need(2);
      return Footprint::disc(size[0], size[1]);
  }
  throw InputError("shape = " + std::to_string(patch.shape) + "; allowed: 0 to 3 (screed_shape)");
}

void add_body(screed_soil& soil, std::vector<screed_patch> patches) {
  Body body;
  for (const screed_patch& patch : patches) body.footprints.push_back(footprint_of(patch));
  body.memories.resize(patches.size());
  body.contacts.resize(patches.size());
  for (size_t i = 0; i < patches.size(); ++i) {
    FootprintMotion motion;
    motion.soil_friction = patches[i].friction;
    motion.adhesion_pa = patches[i].adhesion;
    motion.lug_height_m = patches[i].lug_height;
    body.contacts[i] = {&body.footprints[i], &body.memories[i], motion};
  }
  body.patches = std::move(patches);
  soil.bodies.push_back(std::move(body));  // a vector that moves keeps its elements' addresses
}

// Making a bed.

struct Model {  // of soil and of how it is computed
  SoilParameters soil;
  SoilOptions options;
};

void apply(const screed_setting& setting, Model& model) {
  require_pointer(setting.key, "setting: key");
  const auto is_switch = [&] {
    require(setting.value == 0.0 || setting.value == 1.0, setting.key, setting.value, "0 or 1");
    return setting.value == 1.0;
  };
  const std::string key = setting.key;
  if (key == "bulldozing") {
    model.options.bulldozing = is_switch();
  } else if (key == "avalanches") {
    model.options.avalanches = is_switch();
  } else if (key == "vertical_stress") {
    model.options.normal_stress = is_switch() ? NormalStress::kVertical : NormalStress::kRadial;
  } else {
    const auto* row = std::find_if(std::begin(kSoilParameters), std::end(kSoilParameters),
                                   [&](const SoilParameterInfo& it) { return key == it.key; });
    if (row == std::end(kSoilParameters)) {
      throw InputError("no setting '" + key +
                       "'; allowed: bulldozing, avalanches, vertical_stress and what "
                       "screed_soil_key() lists");
    }
    model.soil.*row->member = setting.value;
  }
}

BedEdge edge_of(int edge) {
  if (edge == SCREED_EDGE_OPEN) return BedEdge::kOpen;
  if (edge == SCREED_EDGE_WRAPPED) return BedEdge::kWrapped;
  if (edge == SCREED_EDGE_WALLED) return BedEdge::kWalled;
  throw InputError("edge = " + std::to_string(edge) + "; allowed: 0 to 2 (screed_edge)");
}

HeightField field_of(const screed_bed& bed) {
  const BedEdge edge = edge_of(bed.edge);
  HeightField field(bed.nodes_x, bed.nodes_y, bed.spacing, edge == BedEdge::kWrapped);
  if (edge == BedEdge::kWalled) field.add_walls();
  if (bed.heights == nullptr) return field;
  const double* height = bed.heights;
  for (int iy = 0; iy < bed.nodes_y; ++iy) {
    for (int ix = 0; ix < bed.nodes_x; ++ix, ++height) {
      require(std::abs(*height) <= 127.0, "height", *height, "-127 to 127 m");
      field.set_node(ix, iy, static_cast<Height>(std::lround(*height / kHeightUnit_m)));
    }
  }
  field.refresh_bounds();
  return field;
}

screed_soil* make_soil(HeightField field, Model model) {
  check_soil(model.soil);
  return new screed_soil(SoilBed(std::move(field), model.soil, model.options));
}

// A state as bytes.

/// What serialize() of the bed and its bodies does not hold, since it makes them.
struct Making {
  FieldBytes field;
  Model model;
  std::vector<std::vector<screed_patch>> bodies;

  template <typename Archive>
  void serialize(Archive& archive) {
    archive(field, model.soil.name);
    for (const SoilParameterInfo& it : kSoilParameters) archive(model.soil.*it.member);
    SoilOptions& options = model.options;
    archive(options.normal_stress, options.bulldozing, options.avalanches, options.follow_slopes,
            options.sample_spacing_m, bodies);
  }
};

Making making_of(const screed_soil& soil) {
  Making making{bytes_of(soil.bed.surface()), {soil.bed.soil(), soil.bed.options()}, {}};
  for (const Body& body : soil.bodies) making.bodies.push_back(body.patches);
  return making;
}

template <typename Archive>
void serialize_rest(Archive& archive, screed_soil& soil) {
  archive(soil.bed);
  for (Body& body : soil.bodies) {
    archive(body.memory);
    for (ContactMemory& memory : body.memories) archive(memory);
  }
}

constexpr StateName kName = {"soil", 1};

std::string state_of(const screed_soil& soil) {
  std::ostringstream rest;
  cereal::PortableBinaryOutputArchive archive(rest);
  archive(making_of(soil));
  serialize_rest(archive, const_cast<screed_soil&>(soil));  // an archive that writes only reads
  return with_head(kName, rest.view());
}

screed_soil* soil_from(std::string_view state) {
  std::istringstream bytes{std::string(without_head(kName, state))};
  cereal::PortableBinaryInputArchive archive(bytes);
  Making making;
  archive(making);
  std::unique_ptr<screed_soil> soil(make_soil(field_of(making.field), making.model));
  for (std::vector<screed_patch>& patches : making.bodies) add_body(*soil, std::move(patches));
  serialize_rest(archive, *soil);
  return soil.release();
}

}  // namespace

template <typename Archive>
void serialize(Archive& archive, screed_patch& patch) {
  archive(patch.shape, patch.size, patch.friction, patch.adhesion, patch.lug_height);
}

// The interface.

const char* screed_soil_version() {
  return SCREED_VERSION;
}

screed_soil* screed_soil_create(const screed_bed* bed, const char* preset,
                                const screed_setting* settings, size_t count, screed_error* error) {
  screed_soil* soil = nullptr;
  attempt(error, [&] {
    require_pointer(bed, "bed");
    require_pointer(preset, "preset");
    if (count > 0) require_pointer(settings, "settings");
    Model model{soil_preset(preset), {}};
    for (size_t i = 0; i < count; ++i) apply(settings[i], model);
    soil = make_soil(field_of(*bed), std::move(model));
  });
  return soil;
}

void screed_soil_destroy(screed_soil* soil) {
  destroy(soil);
}

const char* screed_soil_preset(size_t index) {
  return index < soil_presets().size() ? soil_presets()[index].soil.name.c_str() : nullptr;
}

const char* screed_soil_key(size_t index) {
  return index < std::size(kSoilParameters) ? kSoilParameters[index].key : nullptr;
}

screed_status screed_soil_parameter(const screed_soil* soil, const char* key, double* value,
                                    screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil, "soil");
    require_pointer(key, "key");
    require_pointer(value, "value");
    for (const SoilParameterInfo& it : kSoilParameters) {
      if (std::strcmp(key, it.key) == 0) {
        *value = soil->bed.soil().*it.member;
        return;
      }
    }
    throw InputError(std::string("no parameter '") + key + "'; screed_soil_key() lists them");
  });
}

int screed_soil_add_body(screed_soil* soil, const screed_patch* patches, size_t count,
                         screed_error* error) {
  constexpr size_t kMaxPatches = 1024;
  int index = -1;
  attempt(error, [&] {
    const Use use(soil, "soil");
    require_pointer(patches, "patches");
    require(count >= 1 && count <= kMaxPatches, "count of patches", static_cast<double>(count),
            "1 to 1024");
    add_body(*soil, {patches, patches + count});
    index = static_cast<int>(soil->bodies.size()) - 1;
  });
  return index;
}

screed_status screed_soil_press(screed_soil* soil, int body, const screed_body_motion* motion,
                                const screed_patch_motion* patches, double dt,
                                screed_wrench* wrenches, screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil, "soil");
    if (body < 0 || static_cast<size_t>(body) >= soil->bodies.size()) {
      throw InputError("body = " + std::to_string(body) + "; allowed: numbers of bodies, " +
                       std::to_string(soil->bodies.size()) + " were added");
    }
    require_pointer(motion, "motion");
    require_pointer(patches, "patches");
    require_pointer(wrenches, "wrenches");
    require(dt >= 1e-5 && dt <= 0.02, "dt", dt, "0.00001 to 0.02 s");
    require(motion->mass >= 1e-6, "mass", motion->mass, "0.000001 kg and more");
    const HeightField& field = soil->bed.surface();
    const double farthest = 10.0 * std::max(field.x_max(), field.y_max());
    PressingBody pressing;
    pressing.mass_kg = motion->mass;
    pressing.inverse_inertia = inverse_inertia_from(motion->inertia);
    pressing.centre = vector_from(motion->centre, "centre", farthest, "within ten beds, m");
    pressing.velocity = vector_from(motion->velocity, "velocity", 1e3, "-1000 to 1000 m/s");
    pressing.omega = vector_from(motion->omega, "omega", 1e4, "-10000 to 10000 rad/s");
    Body& its = soil->bodies[static_cast<size_t>(body)];
    std::vector<Eigen::Isometry3d> poses(its.footprints.size(), Eigen::Isometry3d::Identity());
    for (size_t i = 0; i < poses.size(); ++i) {
      poses[i].linear() = rotation_from(patches[i].axes);
      poses[i].translation() =
          vector_from(patches[i].position, "position", farthest, "within ten beds, m");
      require(std::abs(patches[i].surface_speed) <= 1e3, "surface_speed", patches[i].surface_speed,
              "-1000 to 1000 m/s");
    }
    for (size_t i = 0; i < poses.size(); ++i) {
      its.footprints[i].set_pose(poses[i]);
      FootprintMotion& its_motion = its.contacts[i].motion;
      its_motion.velocity =
          pressing.velocity + pressing.omega.cross(poses[i].translation() - pressing.centre);
      its_motion.omega = pressing.omega;
      its_motion.surface_speed = patches[i].surface_speed;
      its_motion.slip =
          signed_slip(its_motion.surface_speed, its_motion.velocity.dot(poses[i].linear().col(0)));
      its.contacts[i].reaction = {};
    }
    soil->bed.press(pressing, its.contacts, dt, its.memory);
    soil->in_step = true;
    for (size_t i = 0; i < poses.size(); ++i) {
      const TerrainReaction& reaction = its.contacts[i].reaction;
      screed_wrench& wrench = wrenches[i];
      std::copy_n(reaction.force.data(), 3, wrench.force);
      std::copy_n(reaction.torque.data(), 3, wrench.torque);
      wrench.along_surface = reaction.along_surface;
      wrench.load = reaction.normal_load;
      wrench.sinkage = reaction.sinkage;
      wrench.area = reaction.area;
    }
  });
}

screed_status screed_soil_end_step(screed_soil* soil, screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil, "soil");
    soil->bed.end_step();
    soil->in_step = false;
  });
}

double screed_soil_height(const screed_soil* soil, double x, double y) {
  double height = std::nan("");
  attempt(nullptr, [&] {
    const Use use(soil, "soil");
    height = soil->bed.surface().at(x, y).height;
  });
  return height;
}

screed_status screed_soil_heights(const screed_soil* soil, const screed_rectangle* part,
                                  double* heights, screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil, "soil");
    copy_heights(soil->bed.surface(), part, heights);
  });
}

screed_status screed_soil_changed(screed_soil* soil, screed_rectangle* changed,
                                  screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil, "soil");
    require_pointer(changed, "changed");
    const HeightField& field = soil->bed.surface();
    const std::vector<uint32_t>& now = field.tile_revisions();
    const bool first = soil->seen.empty();
    Eigen::AlignedBox2i box;
    for (size_t tile = 0; tile < now.size(); ++tile) {
      if (!first && now[tile] == soil->seen[tile]) continue;
      const auto column = static_cast<int>(tile) % field.tiles_x();
      const auto row = static_cast<int>(tile) / field.tiles_x();
      box.extend(Eigen::Vector2i(column, row) * HeightField::kTileNodes);
      box.extend(Eigen::Vector2i(column + 1, row + 1) * HeightField::kTileNodes);
    }
    soil->seen = now;
    *changed = {};
    if (box.isEmpty()) return;
    const Eigen::Vector2i end = box.max().cwiseMin(Eigen::Vector2i(field.nx(), field.ny()));
    *changed = {box.min().x(), box.min().y(), end.x() - box.min().x(), end.y() - box.min().y()};
  });
}

screed_status screed_soil_volumes(const screed_soil* soil, screed_volumes* volumes,
                                  screed_error* error) {
  return attempt(error, [&] {
    const Use use(soil, "soil");
    require_pointer(volumes, "volumes");
    const VolumeBalance balance = soil->bed.balance();
    const double spacing = soil->bed.surface().spacing_m();
    *volumes = {balance.before, balance.now, balance.compacted, balance.in_transit,
                kHeightUnit_m * spacing * spacing};
  });
}

size_t screed_soil_save(const screed_soil* soil, void* state, size_t room, screed_error* error) {
  size_t size = 0;
  attempt(error, [&] {
    const Use use(soil, "soil");
    if (soil->in_step) throw InputError("save: in the middle of a step; allowed: after its end");
    const std::string bytes = state_of(*soil);
    if (bytes.size() <= room) {
      require_pointer(state, "state");
      std::memcpy(state, bytes.data(), bytes.size());
    }
    size = bytes.size();
  });
  return size;
}

screed_soil* screed_soil_load(const void* state, size_t size, screed_error* error) {
  screed_soil* soil = nullptr;
  attempt(error, [&] {
    require_pointer(state, "state");
    soil = soil_from({static_cast<const char*>(state), size});
  });
  return soil;
}
