// Environments: arrays and files to maps that light, conversions, findings.
#include <array>
#include <memory>
#include <utility>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "options.h"
#include "relumine/ask/environment_doctor.h"
#include "relumine/in/environment_files.h"
#include "relumine/light/light_lists.h"
#include "run.h"
#include "scene.h"

namespace relumine::python {

namespace {

using Path = std::filesystem::path;
using ImagePointer = std::shared_ptr<const cubemap::EnvironmentImage>;
using EnvironmentPointer = std::shared_ptr<EnvironmentHandle>;

EnvironmentPointer made_of(ImagePointer image, const EnvironmentOptions& options) {
    auto result = std::make_shared<EnvironmentHandle>();
    result->made = environment_of(std::move(image), options);
    result->options = options;
    return result;
}

EnvironmentPointer loaded_environment(const Path& path, const py::dict& given) {
    return in_background(py::none(),
                         [path, options = options_from<EnvironmentOptions>(given)](const Reins&) {
                             return made_of(std::make_shared<const cubemap::EnvironmentImage>(
                                                load_environment_image(path, options)),
                                            options);
                         });
}

/// `pixels` is [height, width, 3].
EnvironmentPointer from_pixels(const py::buffer& pixels, std::uint32_t width, std::uint32_t height,
                               const py::dict& given) {
    cubemap::Picture picture{.width = width, .height = height, .pixels = vec3s(pixels)};
    return in_background(py::none(),
                         [picture = std::move(picture),
                          options = options_from<EnvironmentOptions>(given)](const Reins&) mutable {
                             try {
                                 return made_of(std::make_shared<const cubemap::EnvironmentImage>(
                                                    environment_image(std::move(picture), options)),
                                                options);
                             } catch (const std::runtime_error& error) { // no file is at fault
                                 throw std::invalid_argument(error.what());
                             }
                         });
}

/// All that an environment is made of, for pickles: shape, layout, sampling, what was assumed, and
/// the angles. The pixels are a property of their own.
py::tuple state_of(const EnvironmentHandle& own) {
    const cubemap::EnvironmentImage& image = *own.made.file.image;
    std::array<double, 9> turn{};
    for (std::size_t i = 0; i < turn.size(); ++i)
        turn[i] = own.options.turn[static_cast<int>(i / 3)][static_cast<int>(i % 3)];
    return py::make_tuple(image.width, image.height, static_cast<int>(image.layout),
                          static_cast<int>(image.sampling), image.assumptions, own.options.from,
                          own.made.map.resolution, static_cast<int>(own.options.flip),
                          own.options.tilt_degrees, own.options.rotate_degrees, turn);
}

EnvironmentPointer from_state(const py::buffer& pixels, const py::tuple& state) {
    cubemap::EnvironmentImage image;
    image.width = state[0].cast<std::uint32_t>();
    image.height = state[1].cast<std::uint32_t>();
    image.layout = static_cast<cubemap::Layout>(state[2].cast<int>());
    image.sampling = static_cast<cubemap::Sampling>(state[3].cast<int>());
    image.assumptions = state[4].cast<std::string>();
    image.pixels = vec3s(pixels);
    if (image.pixels.size() != std::size_t{image.width} * image.height)
        throw py::value_error("expected the state of an environment");
    EnvironmentOptions options{.from = state[5].cast<std::string>(),
                               .face_resolution = state[6].cast<std::uint32_t>(),
                               .flip = static_cast<char>(state[7].cast<int>()),
                               .tilt_degrees = state[8].cast<double>(),
                               .rotate_degrees = state[9].cast<double>()};
    const auto turn = state[10].cast<std::array<double, 9>>();
    for (std::size_t i = 0; i < turn.size(); ++i)
        options.turn[static_cast<int>(i / 3)][static_cast<int>(i % 3)] = turn[i];
    return in_background(
        py::none(), [image = std::make_shared<const cubemap::EnvironmentImage>(std::move(image)),
                     options](const Reins&) { return made_of(image, options); });
}

/// Returns the environment of the same image, turned by other angles.
EnvironmentPointer turned_anew(const EnvironmentHandle& own, const py::dict& given,
                               const std::array<std::array<double, 3>, 3>& turn) {
    auto options = options_from<EnvironmentOptions>(given);
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            options.turn[static_cast<int>(column)][static_cast<int>(row)] = turn[row][column];
    options.from = own.options.from;
    options.layout = own.options.layout;
    options.fix_bad_pixels = own.options.fix_bad_pixels;
    return in_background(py::none(), [image = own.made.file.image, resampled = own.resampled,
                                      is_same = options.face_resolution == own.made.map.resolution,
                                      options](const Reins&) {
        if (!is_same)
            return made_of(image, options);
        std::shared_ptr<const cubemap::CubeMap> map;
        {
            const std::lock_guard lock(resampled->mutex);
            if (!resampled->map)
                resampled->map =
                    std::make_shared<const cubemap::CubeMap>(unturned_cube_map_of(*image, options));
            map = resampled->map;
        }
        auto result = std::make_shared<EnvironmentHandle>();
        result->made = environment_of(image, *map, options);
        result->resampled = resampled;
        result->options = options;
        return result;
    });
}

/// `env convert`.
cubemap::EnvironmentImage converted(const cubemap::EnvironmentImage& image,
                                    const glm::dmat3& world_from_image,
                                    const cubemap::Convention& to, cubemap::Layout layout,
                                    cubemap::Sampling sampling, cubemap::ImageSize size) {
    if (size.width == 0)
        size = cubemap::conversion_size(image, layout);
    if (!cubemap::fits(layout, size.width, size.height))
        throw std::invalid_argument(
            "size: expected the proportions of a " + std::string(cubemap::name(layout)) + ", got " +
            std::to_string(size.width) + " x " + std::to_string(size.height));
    cubemap::EnvironmentImage result =
        cubemap::convert(image, {layout, sampling, size.width, size.height},
                         glm::transpose(to.world_from(layout)) * world_from_image);
    if (to.swaps_z_faces)
        cubemap::swap_z_faces(result);
    return result;
}

/// Options of a conversion.
struct Target {
    const cubemap::Convention* to = nullptr;
    cubemap::Layout layout = cubemap::Layout::LatLong;
    cubemap::ImageSize size = {};

    Target(const py::dict& given, const cubemap::EnvironmentImage& image, bool six_files) {
        std::string name = "openexr";
        std::optional<cubemap::Layout> asked;
        std::optional<std::uint32_t> resolution;
        take({row<ConventionText>("--to", name, ""), row<LayoutText>("--layout", asked, ""),
              size_row(size.width, size.height, "", {}), row("--face-resolution", resolution, "")},
             given);
        to = cubemap::find_convention(name);
        layout = six_files           ? cubemap::Layout::Cube
                 : to->has_attribute ? image.layout
                                     : to->usual_layout;
        layout = asked.value_or(layout);
        if (!to->reads(layout) || (six_files && layout != cubemap::Layout::Cube))
            throw OptionError("--layout", "expected a layout that fits the file and " + name +
                                              ", got '" + LayoutText::show(layout) + "'");
        if (resolution && size.width == 0)
            size = cubemap::natural_size(layout, *resolution);
        if (std::uint64_t{size.width} * size.height > std::uint64_t{1} << 28)
            throw OptionError("--size", "expected at most 2^28 pixels");
    }
};

/// Returns the pixels and the layout's name.
py::tuple convert_to_array(const EnvironmentHandle& own, const py::dict& given) {
    const cubemap::EnvironmentFile file = own.made.file;
    const Target target(given, *file.image, false);
    cubemap::EnvironmentImage image = in_background(py::none(), [file, target](const Reins&) {
        return converted(*file.image, file.turn, *target.to, target.layout,
                         cubemap::Sampling::TexelCentres, target.size);
    });
    const Shape outer = {image.height, image.width};
    return py::make_tuple(owned(std::move(image.pixels), outer),
                          cubemap::option_name(image.layout));
}

void convert_to_file(const Path& path, const EnvironmentHandle& own, const py::dict& given) {
    cubemap::check_environment_name(path);
    const cubemap::EnvironmentFile file = own.made.file;
    const Target target(given, *file.image, cubemap::environment_files(path).size() > 1);
    in_background(py::none(), [path, file, target](const Reins&) {
        const cubemap::Sampling sampling = target.to->has_attribute
                                               ? cubemap::default_sampling(path, target.layout)
                                               : cubemap::Sampling::TexelCentres;
        cubemap::save_image(path, converted(*file.image, file.turn, *target.to, target.layout,
                                            sampling, target.size));
        return true;
    });
}

py::tuple tuple_of(const glm::dvec3& v) {
    return py::make_tuple(v.x, v.y, v.z);
}

py::dict place_of(const glm::dvec3& direction) {
    const cubemap::SkyAngles angles = cubemap::sky_angles(direction);
    py::dict result;
    result["direction"] = tuple_of(direction);
    result["azimuth_degrees"] = angles.azimuth_degrees;
    result["elevation_degrees"] = angles.elevation_degrees;
    return result;
}

py::dict described(const cubemap::Sun& sun) {
    py::dict result = place_of(sun.direction);
    result["irradiance"] = tuple_of(sun.irradiance);
    result["solid_angle"] = sun.solid_angle;
    result["diameter_degrees"] = cubemap::disc_diameter_degrees(sun.solid_angle);
    result["share_of_power"] = sun.share_of_power;
    result["peak_luminance"] = sun.peak_luminance;
    result["sky_luminance"] = sun.sky_luminance;
    return result;
}

py::dict irradiance_of(const cubemap::CubeMap& map) {
    constexpr std::array<const char*, 6> Axes = {"+X", "-X", "+Y", "-Y", "+Z", "-Z"};
    py::dict result;
    for (std::size_t axis = 0; axis < Axes.size(); ++axis)
        result[Axes[axis]] = tuple_of(
            cubemap::irradiance(map, cubemap::cube_point(cubemap::AllFaces[axis], 0.5, 0.5)));
    return result;
}

/// `info ENV --json`, in the world's axes.
py::dict findings(const EnvironmentHandle& own) {
    struct Found {
        cubemap::EnvironmentStatistics statistics;
        cubemap::SunSearch search;
        std::optional<cubemap::ClippedSun> clipped;
        std::vector<cubemap::SeamFault> faults;
    };
    const ImagePointer image = own.made.file.image;
    const glm::dmat3 turn = own.made.file.turn;
    const Found found = in_background(py::none(), [image](const Reins&) {
        Found result{.statistics = cubemap::statistics(*image),
                     .search = cubemap::find_sun(*image),
                     .clipped = {},
                     .faults = cubemap::seam_faults(*image)};
        result.clipped = cubemap::clipped_sun(*image, result.search, result.statistics);
        return result;
    });
    const cubemap::EnvironmentStatistics& s = found.statistics;
    py::list faults;
    for (const cubemap::SeamFault& fault : found.faults)
        faults.append(py::dict(py::arg("where") = fault.where, py::arg("step_ev") = fault.step_ev,
                               py::arg("usual_step_ev") = fault.usual_step_ev));
    py::dict result;
    result["mean_radiance"] = tuple_of(s.mean_radiance);
    result["mean_luminance"] = s.mean_luminance;
    result["max_luminance"] = s.max_luminance;
    result["min_positive_luminance"] = s.min_positive_luminance;
    result["dynamic_range_ev"] = s.dynamic_range_ev;
    result["brightest_direction"] = tuple_of(turn * s.brightest_direction);
    result["irradiance"] = irradiance_of(own.made.map);
    const double from_below = cubemap::light_from_below(own.made.map);
    result["light_from_below"] = from_below;
    result["upside_down"] = cubemap::upside_down(from_below).has_value();
    result["num_nan"] = image->bad_pixels.num_nan;
    result["num_infinite"] = image->bad_pixels.num_infinite;
    result["num_negative"] = image->bad_pixels.num_negative;
    result["sun"] = py::none();
    result["clipped_sun"] = py::none();
    result["seam_faults"] = std::move(faults);
    if (found.search.sun) {
        cubemap::Sun sun = *found.search.sun;
        sun.direction = turn * sun.direction;
        result["sun"] = described(sun);
    } else {
        result["why_no_sun"] = found.search.why_none;
    }
    if (found.clipped) {
        py::dict clipped = place_of(turn * found.clipped->direction);
        clipped["why"] = found.clipped->why;
        result["clipped_sun"] = std::move(clipped);
    }
    return result;
}

/// Returns (the environment without its sun, direction, irradiance, solid angle), or the reason why
/// there is none.
py::object without_sun(const EnvironmentHandle& own) {
    struct Split {
        lights::DistantLight sun;
        EnvironmentPointer rest;
        std::string why_none;
    };
    const Split split =
        in_background(py::none(), [file = own.made.file, options = own.options](const Reins&) {
            Split result;
            const cubemap::SunSearch search = cubemap::find_sun(*file.image);
            if (!search.sun) {
                result.why_none = search.why_none;
                return result;
            }
            cubemap::EnvironmentImage image = *file.image;
            lights::remove_sun(image, *search.sun);
            result.sun = lights::sun_light(*search.sun);
            result.sun.direction = file.turn * result.sun.direction;
            result.rest = made_of(
                std::make_shared<const cubemap::EnvironmentImage>(std::move(image)), options);
            return result;
        });
    if (!split.rest)
        return py::str(split.why_none);
    return py::make_tuple(split.rest, tuple_of(split.sun.direction), tuple_of(split.sun.irradiance),
                          split.sun.solid_angle);
}

/// Frames on disk, read ahead.
class Frames {
public:
    Frames(const std::string& name, const std::optional<std::string>& range, const py::dict& given)
        : options_(options_from<EnvironmentOptions>(given)),
          sequence_(
              cubemap::find_frames(name, range ? std::optional(cubemap::FrameRange::parse(*range))
                                               : std::nullopt),
              [options = options_](const Path& path) {
                  return load_environment_image(path, options);
              }) {}

    [[nodiscard]] std::size_t size() const { return sequence_.size(); }
    [[nodiscard]] std::int64_t number(std::size_t frame) const { return sequence_.number(frame); }
    [[nodiscard]] Path path(std::size_t frame) const { return sequence_.path(frame); }

    EnvironmentPointer load(std::size_t frame) {
        return made_of(std::make_shared<const cubemap::EnvironmentImage>(sequence_.load(frame)),
                       options_);
    }

private:
    EnvironmentOptions options_;
    cubemap::FrameSequence sequence_;
};

} // namespace

void bind_environments(py::module_& module) {
    using Handle = EnvironmentHandle;
    py::class_<Handle, EnvironmentPointer>(module, "Environment")
        .def_property_readonly("cube",
                               [](const EnvironmentPointer& own) {
                                   const auto r =
                                       static_cast<py::ssize_t>(own->made.map.resolution);
                                   return view(own, own->made.map.texels, {6, r, r});
                               })
        .def_property_readonly("pixels",
                               [](const EnvironmentPointer& own) {
                                   const cubemap::EnvironmentImage& image = *own->made.file.image;
                                   return view(own->made.file.image, image.pixels,
                                               {image.height, image.width});
                               })
        .def_property_readonly(
            "layout",
            [](const Handle& own) { return cubemap::option_name(own.made.file.image->layout); })
        .def_property_readonly("assumptions",
                               [](const Handle& own) { return own.made.assumptions; })
        .def_property_readonly("warnings", [](const Handle& own) { return own.made.warnings; })
        .def_property_readonly("num_fixed_pixels",
                               [](const Handle& own) { return own.made.num_fixed_pixels; })
        .def_property_readonly("angles",
                               [](const Handle& own) {
                                   return py::make_tuple(
                                       own.options.flip == 0 ? std::string()
                                                             : std::string(1, own.options.flip),
                                       own.options.tilt_degrees, own.options.rotate_degrees);
                               })
        .def_property_readonly("face_resolution",
                               [](const Handle& own) { return own.made.map.resolution; })
        .def("turned", &turned_anew)
        .def("state", &state_of)
        .def("findings", &findings)
        .def("without_sun", &without_sun);
    module.def("load_environment", &loaded_environment);
    module.def("environment_from_pixels", &from_pixels);
    module.def("environment_from_state", &from_state);
    module.def("convert_to_array", &convert_to_array);
    module.def("convert_to_file", &convert_to_file);
    module.def("irradiance", [](const Handle& own, const std::array<double, 3>& n) {
        return tuple_of(cubemap::irradiance(own.made.map, glm::dvec3(n[0], n[1], n[2])));
    });

    py::class_<Frames, std::shared_ptr<Frames>>(module, "Frames")
        .def(py::init(
            [](const std::string& name, const std::optional<std::string>& range,
               const py::dict& given) { return std::make_shared<Frames>(name, range, given); }))
        .def("__len__", &Frames::size)
        .def("number", &Frames::number)
        .def("path", &Frames::path)
        .def("load", [](const std::shared_ptr<Frames>& own, std::size_t frame) {
            return in_background(py::none(),
                                 [own, frame](const Reins&) { return own->load(frame); });
        });
}

} // namespace relumine::python
