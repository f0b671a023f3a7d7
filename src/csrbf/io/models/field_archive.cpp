#include "csrbf/io/models/field_archive.hpp"

#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/approx/moving/moving_least_squares_field.hpp"
#include "csrbf/approx/samples/blended_field.hpp"
#include "csrbf/approx/samples/drift_field.hpp"
#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/approx/samples/mapped_field.hpp"
#include "csrbf/approx/samples/sphere_field.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/approx/unity/tiled_field.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/io/models/average_archive.hpp"
#include "csrbf/io/models/drift_archive.hpp"
#include "csrbf/io/models/field_parts.hpp"
#include "csrbf/io/models/frame_archive.hpp"
#include "csrbf/io/models/lattice_archive.hpp"
#include "csrbf/io/models/tile_store.hpp"
#include "csrbf/io/models/transform_archive.hpp"
#include "csrbf/io/models/variance_archive.hpp"
#include "csrbf/levelset/contour/segment_fields.hpp"
#include "csrbf/linalg/decompositions.hpp"

namespace csrbf {
namespace {

constexpr const char* expansion_kind = "expansion";
constexpr const char* level_sum_kind = "level sum";
constexpr const char* partition_kind = "partition of unity";
constexpr const char* moving_kind = "moving least squares";
constexpr const char* track_kind = "moving least squares along tracks";
constexpr const char* blended_kind = "blended fields";
constexpr const char* mapped_kind = "mapped field";
constexpr const char* largest_kind = "largest level set";
constexpr const char* sphere_kind = "field on the sphere";
constexpr const char* divided_kind = "divided by faults";
constexpr const char* derivatives_kind = "values and derivatives";
// Limits on damaged files, above what fits make.
constexpr std::int64_t most_charts = 64, most_regions = 256, most_levels = 1024;

template <int Dim>
std::shared_ptr<const Expansion<Dim>> expansion_from(const Archive& archive,
                                                     std::shared_ptr<const RadialBasis<Dim>> basis) {
  PolynomialTail<Dim> tail;
  tail.degree = static_cast<int>(archive.integer("tail_degree", -1, most_degree));
  tail.origin = archive.numbers("tail_origin", Dim, 1);
  tail.scale = positive_number(archive, "tail_scale");
  tail.coefficients = archive.numbers("tail_coefficients", -1, 1);
  const Eigen::VectorXd coefficients = archive.numbers("coefficients", basis->size(), 1);
  return std::make_shared<const Expansion<Dim>>(std::move(basis), coefficients, std::move(tail), box_of<Dim>(archive));
}

// The archive of an expansion without its basis.
template <int Dim>
Archive expansion_to_archive(const Expansion<Dim>& field) {
  Archive archive;
  archive.kind = expansion_kind;
  archive.set("coefficients", field.coefficients());
  archive.set("tail_degree", field.tail().degree);
  archive.set("tail_origin", field.tail().origin);
  archive.set("tail_scale", field.tail().scale);
  archive.set("tail_coefficients", field.tail().coefficients);
  set_box(archive, field.bounds());
  return archive;
}

}  // namespace

bool is_field_kind(const std::string& kind) {
  return kind == expansion_kind || kind == level_sum_kind || kind == partition_kind || kind == moving_kind ||
         kind == track_kind || kind == blended_kind || kind == fitted_kind || kind == lattice_kind ||
         kind == largest_kind || kind == sphere_kind || kind == drift_kind || kind == derivatives_kind ||
         kind == divided_kind || kind == tiled_kind || kind == mapped_kind || kind == average_kind ||
         kind == transformed_back_kind;
}

template <int Dim>
std::int64_t FieldWriter<Dim>::share(const void* object, const std::function<Archive()>& to_archive) {
  const auto [entry, is_new] = numbers_.try_emplace(object, static_cast<std::int64_t>(shared_.size()));
  if (is_new) shared_.push_back(to_archive());
  return entry->second;
}

template <int Dim>
Archive FieldWriter<Dim>::field(const Field<Dim>& field) {
  Archive archive;
  if (const auto* fitted = dynamic_cast<const FittedField<Dim>*>(&field)) {
    archive = frame_to_archive<Dim>(fitted->frame());
    archive.set("inner", this->field(fitted->inner()));
  } else if (const auto* mapped = dynamic_cast<const MappedField<Dim>*>(&field)) {
    archive.kind = mapped_kind;
    archive.set("map", mapped->map());
    archive.set("inner", this->field(mapped->inner()));
  } else if (const auto* expansion = dynamic_cast<const Expansion<Dim>*>(&field)) {
    archive = expansion_to_archive(*expansion);
    const RadialBasis<Dim>& basis = expansion->basis();
    archive.set("basis", share(&basis, [&] { return to_archive(basis); }));
  } else if (const auto* average = dynamic_cast<const AverageField<Dim>*>(&field)) {
    archive = average_to_archive<Dim>(*average, [this](const Field<Dim>& one) { return this->field(one); });
  } else if (const auto* variance = dynamic_cast<const KrigingVariance<Dim>*>(&field)) {
    archive = variance_to_archive(*variance);
    const PowerFunction<Dim>& power = variance->power();
    const RadialBasis<Dim>& basis = *power.basis();
    archive.set("basis", share(&basis, [&] { return to_archive(basis); }));
    archive.set("power", share(&power, [&] { return power_to_archive(power); }));
  } else if (const auto* drift = dynamic_cast<const DriftField<Dim>*>(&field)) {
    archive = drift_to_archive(*drift);
  } else if (const auto* back = dynamic_cast<const TransformedBack<Dim>*>(&field)) {
    archive = transform_to_archive<Dim>(*back, [this](const Field<Dim>& one) { return this->field(one); });
  } else if (!few_variables(field, archive) && !level_set(field, archive)) {
    throw InvalidInput("write_model: field: this kind of field has no file form");
  }
  return archive;
}

// The archive of a field of a method that is not for many variables.
template <int Dim>
bool FieldWriter<Dim>::few_variables([[maybe_unused]] const Field<Dim>& field, [[maybe_unused]] Archive& archive) {
  if constexpr (Dim <= largest_dimension) {
    if constexpr (Dim <= 3) {
      if (const auto* grown = dynamic_cast<const GrownVariance<Dim>*>(&field)) {
        archive = grown_to_archive<Dim>(*grown, [this](const Field<Dim>& part) { return this->field(part); });
        archive.set("places", share(&grown->places(), [&] { return places_to_archive<Dim>(grown->places()); }));
        return true;
      }
    }
    if (const auto* sum = dynamic_cast<const LevelSum<Dim>*>(&field)) {
      archive.kind = level_sum_kind;
      set_box(archive, sum->bounds());
      archive.set("levels", sum->levels().size());
      for (std::size_t i = 0; i < sum->levels().size(); ++i)
        archive.set("level" + std::to_string(i), this->field(*sum->levels()[i]));
    } else if (const auto* partition = dynamic_cast<const PartitionOfUnity<Dim>*>(&field)) {
      archive.kind = partition_kind;
      archive.set("component", partition->component());
      archive.set("data", share(&partition->data(), [&] { return patches_to_archive<Dim>(partition->data()); }));
    } else if (const auto* moving = dynamic_cast<const MovingLeastSquares<Dim>*>(&field)) {
      archive.kind = moving->data().directions.cols() > 0 ? track_kind : moving_kind;
      archive.set("component", moving->component());
      archive.set("data", share(&moving->data(), [&] { return samples_to_archive<Dim>(moving->data()); }));
    } else if (const auto* blended = dynamic_cast<const BlendedField<Dim>*>(&field)) {
      archive.kind = blended_kind;
      archive.set("one", this->field(blended->one()));
      archive.set("has_other", blended->other() != nullptr ? 1 : 0);
      if (blended->other() != nullptr) archive.set("other", this->field(*blended->other()));
      archive.set("share", this->field(blended->share()));
    } else if (const auto* hermite = dynamic_cast<const HermiteField<Dim>*>(&field)) {
      archive.kind = derivatives_kind;
      archive.set("component", hermite->component());
      archive.set("is_variance", hermite->is_variance() ? 1 : 0);
      archive.set("data", share(hermite->data().get(), [&] { return hermite_to_archive<Dim>(*hermite->data()); }));
    } else if (const auto* sphere = dynamic_cast<const SphereField<Dim>*>(&field)) {
      archive = this->sphere(*sphere);
    } else if (const auto* tiled = dynamic_cast<const TiledField<Dim>*>(&field)) {
      archive = tiled_to_archive(*tiled, tiles_);
    } else {
      return false;
    }
    return true;
  }
  return false;
}

template <int Dim>
Archive FieldWriter<Dim>::sphere([[maybe_unused]] const SphereField<Dim>& field) {
  Archive archive;
  if constexpr (Dim <= largest_dimension) {
    const typename SphereField<Dim>::Parts& parts = field.parts();
    archive.kind = sphere_kind;
    set_box(archive, field.bounds());
    archive.set("longitude", parts.longitude);
    archive.set("latitude", parts.latitude);
    archive.set("charts", parts.charts.size());
    for (std::size_t i = 0; i < parts.charts.size(); ++i) {
      Archive chart = this->field(*parts.charts[i].field);
      chart.set("chart_axes", parts.charts[i].chart.axes);
      archive.set("chart" + std::to_string(i), std::move(chart));
    }
    archive.set("has_space", parts.space ? 1 : 0);
    if constexpr (SphereField<Dim>::space_dim > Dim)
      if (parts.space) archive.set("space", alone(*parts.space));
  }
  return archive;
}

// The archive of a field of one dimension or two: a level set of a segmentation, or one divided by faults.
template <int Dim>
bool FieldWriter<Dim>::level_set(const Field<Dim>& field, Archive& archive) {
  if constexpr (Dim == 2) {
    if (const auto* divided = dynamic_cast<const FaultField*>(&field)) {
      archive.kind = divided_kind;
      archive.set("component", divided->component());
      archive.set("is_variance", divided->is_variance() ? 1 : 0);
      archive.set("data", share(divided->data().get(), [&] { return faults_to_archive(*divided->data()); }));
      return true;
    }
  }
  if constexpr (Dim == 2 || Dim == 3) {
    if (const auto* lattice = dynamic_cast<const LatticeField<Dim>*>(&field)) {
      archive = to_archive(*lattice);
      return true;
    }
    if (const auto* largest = dynamic_cast<const LargestField<Dim>*>(&field)) {
      archive.kind = largest_kind;
      archive.set("number", largest->number());
      archive.set("fields", largest->fields().size());
      for (std::size_t i = 0; i < largest->fields().size(); ++i) {
        const Field<Dim>& one = *largest->fields()[i];
        archive.set("field" + std::to_string(i), share(&one, [&] { return this->field(one); }));
      }
      return true;
    }
  }
  return false;
}

template <int Dim>
void FieldWriter<Dim>::store_shared(Archive& archive) {
  for (std::size_t i = 0; i < shared_.size(); ++i) archive.set("shared" + std::to_string(i), std::move(shared_[i]));
  shared_.clear();
  numbers_.clear();
  if constexpr (Dim <= largest_dimension)
    if (tiles_) set_tile_sizes(archive, *tiles_);
  tiles_.reset();
}

template <int Dim>
template <class T>
std::shared_ptr<const T> FieldReader<Dim>::shared(
    const Archive& user, const std::string& name, const char* kind,
    const std::function<std::shared_ptr<const T>(const Archive&)>& from_archive) {
  const std::int64_t number = user.integer(name);
  const std::string prefix = "shared" + std::to_string(number);
  if (archive_.text(prefix + "/kind") != kind) archive_.fail("\"" + prefix + "\" is not a " + kind);
  std::shared_ptr<const void>& object = read_[number];
  if (!object) object = from_archive(archive_.part(prefix));
  return std::static_pointer_cast<const T>(object);  // its kind determines its type
}

template <int Dim>
std::shared_ptr<const Field<Dim>> FieldReader<Dim>::field(const Archive& archive) {
  if (archive.kind == fitted_kind) {
    const Archive inner = archive.part("inner");
    if (inner.kind == fitted_kind) archive.fail("a fitted field is inside another one");
    return std::make_shared<const FittedField<Dim>>(field(inner), frame_from<Dim>(archive));
  }
  if (archive.kind == mapped_kind) {
    const typename MappedField<Dim>::Map map = archive.numbers("map", Dim, Dim);
    const Archive inner = archive.part("inner");
    if (inner.kind == mapped_kind || inner.kind == fitted_kind) archive.fail("a field is mapped twice");
    if (!map.allFinite() || !is_regular(map)) archive.fail("the map is damaged");
    return std::make_shared<const MappedField<Dim>>(field(inner), map);
  }
  if (archive.kind == expansion_kind) return expansion(archive);
  if (archive.kind == average_kind)
    return average_from<Dim>(archive, [this](const Archive& part) { return this->field(part); });
  if (archive.kind == variance_kind) {
    const auto basis = shared<RadialBasis<Dim>>(archive, "basis", basis_kind, basis_from<Dim>);
    const auto power = shared<PowerFunction<Dim>>(archive, "power", power_kind,
                                                  [&](const Archive& part) { return power_from<Dim>(part, basis); });
    return variance_from<Dim>(archive, power);
  }
  if (archive.kind == drift_kind) return drift_field_from<Dim>(archive);
  if (archive.kind == transformed_back_kind)
    return transform_from<Dim>(archive, [this](const Archive& part) { return this->field(part); });
  if (auto few = few_variables(archive)) return few;
  if (auto level_set = this->level_set(archive)) return level_set;
  archive.fail("this version knows no field of the kind \"" + archive.kind + "\"");
}

template <int Dim>
std::shared_ptr<const Expansion<Dim>> FieldReader<Dim>::expansion(const Archive& archive) {
  return expansion_from<Dim>(archive, shared<RadialBasis<Dim>>(archive, "basis", basis_kind, basis_from<Dim>));
}

// A field of a method that is not for many variables.
template <int Dim>
std::shared_ptr<const Field<Dim>> FieldReader<Dim>::few_variables([[maybe_unused]] const Archive& archive) {
  if constexpr (Dim <= largest_dimension) {
    using Patches = typename PartitionOfUnity<Dim>::Data;
    using Moving = typename MovingLeastSquares<Dim>::Data;
    if constexpr (Dim <= 3) {
      if (archive.kind == grown_kind) {
        const auto places = shared<SamplePlaces<Dim>>(archive, "places", places_kind, places_from<Dim>);
        return grown_from<Dim>(archive, places, [this](const Archive& part) { return this->field(part); });
      }
    }
    if (archive.kind == level_sum_kind) {
      std::vector<std::shared_ptr<const Expansion<Dim>>> levels;
      for (std::int64_t i = 0, count = archive.integer("levels", 0, most_levels); i < count; ++i) {
        levels.push_back(expansion(archive.part("level" + std::to_string(i))));
      }
      return std::make_shared<const LevelSum<Dim>>(std::move(levels), box_of<Dim>(archive));
    }
    if (archive.kind == partition_kind) {
      const auto data = shared<Patches>(archive, "data", patches_kind, patches_from<Dim>);
      const Index component = archive.integer("component", 0, data->models.components - 1);
      return std::make_shared<const PartitionOfUnity<Dim>>(data, component);
    }
    if (archive.kind == moving_kind || archive.kind == track_kind) {
      const auto data = shared<Moving>(archive, "data", samples_kind, samples_from<Dim>);
      if ((data->directions.cols() > 0) != (archive.kind == track_kind))
        archive.fail("directions of tracks belong to the kind \"" + std::string(track_kind) + "\" and to no other");
      const Index component = archive.integer("component", 0, data->samples.components() - 1);
      return std::make_shared<const MovingLeastSquares<Dim>>(data, component);
    }
    if (archive.kind == blended_kind) {
      const auto other = archive.integer("has_other", 0, 1) == 1 ? field(archive.part("other")) : nullptr;
      return std::make_shared<const BlendedField<Dim>>(field(archive.part("one")), other, field(archive.part("share")));
    }
    if (archive.kind == derivatives_kind) {
      const auto data = shared<typename HermiteField<Dim>::Data>(archive, "data", hermite_kind, hermite_from<Dim>);
      const Index component = archive.integer("component", 0, data->patches.front().mean.size() - 1);
      return std::make_shared<const HermiteField<Dim>>(data, component, archive.integer("is_variance", 0, 1) == 1);
    }
    if (archive.kind == sphere_kind) return sphere(archive);
    if (archive.kind == tiled_kind) return tiled_from(archive, archive_, tiles_);
  }
  return nullptr;
}

template <int Dim>
std::shared_ptr<const Field<Dim>> FieldReader<Dim>::sphere([[maybe_unused]] const Archive& archive) {
  if constexpr (Dim <= largest_dimension) {
    typename SphereField<Dim>::Parts parts;
    parts.longitude = static_cast<int>(archive.integer("longitude", 0, Dim - 1));
    parts.latitude = static_cast<int>(archive.integer("latitude", 0, Dim - 1));
    const std::int64_t charts = archive.integer("charts", 0, most_charts);
    const bool has_space = archive.integer("has_space", 0, 1) == 1;
    if (parts.longitude == parts.latitude || (charts == 0 && !has_space)) archive.fail("the sphere is damaged");
    for (std::int64_t i = 0; i < charts; ++i) {
      const Archive chart = archive.part("chart" + std::to_string(i));
      if (chart.kind == sphere_kind) archive.fail("a sphere is inside another one");
      parts.charts.push_back({{Eigen::Matrix3d(chart.numbers("chart_axes", 3, 3))}, field(chart)});
    }
    if (has_space) {
      if constexpr (SphereField<Dim>::space_dim > Dim)
        parts.space = alone_from<SphereField<Dim>::space_dim>(archive.part("space"));
      else
        archive.fail("the sphere has too many coordinates");
    }
    return std::make_shared<const SphereField<Dim>>(std::move(parts), box_of<Dim>(archive));
  } else {
    return nullptr;
  }
}

// The same fields.
template <int Dim>
std::shared_ptr<const Field<Dim>> FieldReader<Dim>::level_set(const Archive& archive) {
  if constexpr (Dim == 2) {
    if (archive.kind == divided_kind) {
      const auto data = shared<FaultField::Data>(archive, "data", faults_kind, faults_from);
      const Index component = archive.integer("component", 0, data->models.components - 1);
      return std::make_shared<const FaultField>(data, component, archive.integer("is_variance", 0, 1) == 1);
    }
  }
  if constexpr (Dim == 2 || Dim == 3) {
    if (archive.kind == lattice_kind) return lattice_field_from<Dim>(archive);
    if (archive.kind == largest_kind) {
      typename LargestField<Dim>::Fields fields;
      const std::int64_t count = archive.integer("fields", 2, most_regions);
      for (std::int64_t i = 0; i < count; ++i)
        fields.push_back(
            shared<LatticeField<Dim>>(archive, "field" + std::to_string(i), lattice_kind, lattice_field_from<Dim>));
      const std::int64_t number = archive.integer("number", 0, count - 1);
      return std::make_shared<const LargestField<Dim>>(std::move(fields), static_cast<std::size_t>(number));
    }
  }
  return nullptr;
}

#define CSRBF_INSTANTIATE(Dim)     \
  template class FieldWriter<Dim>; \
  template class FieldReader<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
