// Light lists.
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "lights.h"
#include "options.h"
#include "relumine/light/light_lists.h"
#include "run.h"
#include "scene.h"

namespace relumine::python {

namespace {

using Path = std::filesystem::path;

} // namespace

LightArrays arrays_of(const std::vector<lights::DistantLight>& lights) {
    std::vector<glm::dvec3> directions, irradiances;
    std::vector<double> solid_angles;
    for (const lights::DistantLight& light : lights) {
        directions.push_back(light.direction);
        irradiances.push_back(light.irradiance);
        solid_angles.push_back(light.solid_angle);
    }
    return {owned(std::move(directions)), owned(std::move(irradiances)),
            owned(std::move(solid_angles))};
}

std::vector<lights::DistantLight> lights_of(const py::buffer& directions,
                                            const py::buffer& irradiances,
                                            const py::buffer& solid_angles) {
    const std::vector<glm::dvec3> w = dvec3s(directions);
    const std::vector<glm::dvec3> e = dvec3s(irradiances);
    const std::vector<double> a = doubles(solid_angles);
    if (w.size() != e.size() || w.size() != a.size())
        throw py::value_error("lights: expected as many irradiances and solid angles as "
                              "directions");
    std::vector<lights::DistantLight> result(w.size());
    for (std::size_t i = 0; i < w.size(); ++i)
        result[i] = {.direction = w[i], .irradiance = e[i], .solid_angle = a[i]};
    return result;
}

namespace {

/// A lat-long as it is in the file; everything else by way of the cube map.
LightArrays place(const EnvironmentHandle& own, std::size_t number, const std::string& method,
                  std::uint64_t seed) {
    const auto known = lights::method_named(method);
    if (!known)
        throw OptionError("--method",
                          "expected median-cut, variance or importance, got '" + method + "'");
    const Environment& made = own.made;
    const bool is_plain = made.file.image->layout == cubemap::Layout::LatLong &&
                          made.file.turn == glm::dmat3(1.0) && own.options.face_resolution == 0;
    const auto placed = [&] {
        const Release release;
        return is_plain ? lights::place(*known, *made.file.image, number, seed).lights
                        : lights::place_lights(*known, made.map, number, seed);
    }();
    return arrays_of(placed);
}

py::tuple loaded_list(const Path& path) {
    const lights::LightList list = lights::load_lights(path);
    return py::make_tuple(arrays_of(list.lights), list.environment, list.method);
}

void save_list(const Path& path, const py::buffer& directions, const py::buffer& irradiances,
               const py::buffer& solid_angles, const std::string& method,
               const std::optional<std::string>& format_name, bool soft, double lumens_per_watt) {
    const auto format =
        format_name ? lights::light_format_named(*format_name) : lights::light_format_of(path);
    if (!format)
        throw py::value_error((format_name ? "format" : "path") +
                              std::string(": expected json, csv, pbrt, mitsuba, usd, blender or "
                                          "gltf, got '") +
                              (format_name ? *format_name : path.string()) + "'");
    const lights::LightList list{.lights = lights_of(directions, irradiances, solid_angles),
                                 .method = method};
    const Release release;
    lights::export_lights(path, list, *format, {.soft = soft, .lumens_per_watt = lumens_per_watt});
}

} // namespace

void bind_lights(py::module_& module) {
    module.def("place_lights", &place);
    module.def("load_lights", &loaded_list);
    module.def("save_lights", &save_list);
}

} // namespace relumine::python
