#include "options.h"

#include <cmath>
#include <utility>
#include <vector>

#include "relight/pictures/framing.h"

namespace relumine::python {

namespace {

/// Returns the place of a word among others.
std::size_t one_of(const Options& given, const char* name, const std::vector<std::string>& words) {
    const auto word = given.find<std::string>(name);
    if (!word)
        return 0;
    std::string list;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == *word)
            return i;
        list += (i == 0 ? "" : ", ") + words[i];
    }
    Options::refuse(name, list, given.given(name));
}

/// Python has made tuples of them: (group, highlight, width, albedo, specular).
std::vector<SurfaceMaterial> materials_of(const py::object& given) {
    std::vector<SurfaceMaterial> result;
    if (given.is_none())
        return result;
    for (const py::handle& item : given) {
        const auto values = item.cast<py::tuple>();
        SurfaceMaterial material{.group = values[0].cast<std::string>(),
                                 .highlight =
                                     static_cast<prt::Highlight>(values[1].cast<unsigned>()),
                                 .roughness_or_exponent = values[2].cast<float>()};
        if (!values[3].is_none())
            material.albedo = vec3_of("material", values[3]);
        if (!values[4].is_none())
            material.specular = vec3_of("material", values[4]);
        result.push_back(std::move(material));
    }
    return result;
}

std::optional<View> view_of(const Options& given) {
    const py::object value = given.given("view");
    if (value.is_none())
        return std::nullopt;
    if (py::isinstance<py::str>(value)) {
        if (value.cast<std::string>() == "auto")
            return View{};
        Options::refuse("view", "'auto' or (eye, target) or (eye, target, fov)", value);
    }
    const py::tuple parts =
        py::isinstance<py::sequence>(value) ? py::tuple(value) : py::make_tuple();
    if (parts.size() != 2 && parts.size() != 3)
        Options::refuse("view", "'auto' or (eye, target) or (eye, target, fov)", value);
    Camera camera{.eye = vec3_of("view", parts[0]), .target = vec3_of("view", parts[1])};
    if (parts.size() == 3)
        camera.fov_degrees = parts[2].cast<float>();
    return View{camera};
}

std::optional<Camera> camera_of(const Options& given, const Scene& scene, float aspect) {
    relight::Framing framing;
    framing.aspect = aspect;
    bool is_plain = true;
    if (given.has("front")) {
        const std::size_t front = one_of(given, "front", {"+z", "-z", "+x", "-x"});
        const double sign = front % 2 == 0 ? 1.0 : -1.0;
        framing.front = front < 2 ? glm::dvec3(0, 0, sign) : glm::dvec3(sign, 0, 0);
        is_plain = false;
    }
    given.take("fov", framing.fov_degrees);
    if (!(framing.fov_degrees > 0.0f && framing.fov_degrees < 180.0f))
        Options::refuse("fov", "degrees between 0 and 180", given.given("fov"));
    if (const py::object angles = given.given("camera"); !angles.is_none()) {
        std::vector<double> numbers;
        try {
            numbers = angles.cast<std::vector<double>>();
        } catch (const py::cast_error&) {
        }
        bool fits = numbers.size() == 2 || (numbers.size() == 3 && numbers[2] > 0.0);
        for (const double number : numbers)
            fits = fits && std::isfinite(number);
        if (!fits || std::abs(numbers[1]) > 90.0)
            Options::refuse("camera", "(azimuth, elevation) or (azimuth, elevation, distance)",
                            angles);
        framing.angles = {.azimuth = numbers[0], .elevation = numbers[1]};
        if (numbers.size() == 3)
            framing.angles.distance = numbers[2];
        is_plain = false;
    }
    Camera camera = is_plain && scene.settings.view ? *scene.settings.view
                                                    : relight::framed(scene.mesh, framing);
    if (const auto target = given.point("target")) {
        camera.eye += *target - camera.target;
        camera.target = *target;
    }
    if (const auto eye = given.point("eye"))
        camera.eye = *eye;
    return camera;
}

Background background_of(const Options& given) {
    const py::object value = given.given("background");
    if (value.is_none())
        return EnvironmentBehind{};
    if (!py::isinstance<py::str>(value))
        return vec3_of("background", value);
    const auto text = value.cast<std::string>();
    if (text == "none")
        return NothingBehind{};
    if (text != "sharp")
        Options::refuse("background", "sharp, none, or a number or (r, g, b)", value);
    return EnvironmentBehind{};
}

Albedo albedo_of(const Options& given) {
    const py::object value = given.given("albedo");
    if (value.is_none())
        return AutomaticAlbedo{};
    if (!py::isinstance<py::str>(value))
        return vec3_of("albedo", value);
    const auto text = value.cast<std::string>();
    if (text != "mesh" && text != "auto")
        Options::refuse("albedo", "auto, mesh, or a number or (r, g, b)", value);
    return text == "mesh" ? Albedo(MeshColors{}) : Albedo(AutomaticAlbedo{});
}

} // namespace

py::object Options::given(const char* name) const {
    return values_.contains(name) ? py::object(values_[name]) : py::object(py::none());
}

void Options::refuse(const char* name, const std::string& expected, const py::object& got) {
    throw py::value_error(std::string(name) + ": expected " + expected + ", got " +
                          py::repr(got).cast<std::string>());
}

glm::vec3 vec3_of(const char* name, const py::object& value) {
    try {
        if (PyNumber_Check(value.ptr()) != 0 && PySequence_Check(value.ptr()) == 0)
            return glm::vec3(value.cast<float>());
        const auto numbers = value.cast<std::vector<float>>();
        if (numbers.size() == 3)
            return {numbers[0], numbers[1], numbers[2]};
    } catch (const py::cast_error&) {
    }
    Options::refuse(name, "a number or three numbers", value);
}

std::optional<glm::vec3> Options::color(const char* name) const {
    return has(name) ? std::optional(vec3_of(name, given(name))) : std::nullopt;
}

std::optional<glm::vec3> Options::point(const char* name) const {
    return color(name);
}

cubemap::Layout layout_named(const char* option, const std::string& name) {
    if (const auto layout = cubemap::layout_named(name))
        return *layout;
    std::string list;
    for (const cubemap::Layout layout : cubemap::AllLayouts)
        list.append(list.empty() ? "" : ", ").append(cubemap::option_name(layout));
    Options::refuse(option, list, py::str(name));
}

TurnedOptions::TurnedOptions(const Options& given) {
    given.take("convention", from);
    if (const auto layout = given.find<std::string>("layout"))
        options.layout = layout_named("layout", *layout);
    given.take("face_resolution", options.face_resolution);
    given.take("fix_env", options.fix_bad_pixels);
    if (given.has("flip"))
        options.flip = "xyz"[one_of(given, "flip", {"x", "y", "z"})];
    given.take("tilt", options.tilt_degrees);
    given.take("rotate", options.rotate_degrees);
    for (const char* name : {"tilt", "rotate"})
        if (!std::isfinite(given.find<double>(name).value_or(0.0)))
            Options::refuse(name, "a finite number of degrees", given.given(name));
}

MeshOptions mesh_options(const Options& given) {
    MeshOptions result;
    if (given.has("up"))
        result.up = static_cast<mesh::UpAxis>(one_of(given, "up", {"x", "y", "z"}));
    if (one_of(given, "normals", {"file", "smooth"}) == 1)
        result.normals = mesh::NormalSource::Smooth;
    given.take("crease", result.crease);
    given.take("floor", result.floor_vertices);
    given.take("floor_scale", result.floor_scale);
    return result;
}

RefineOptions refine_options(const Options& given) {
    RefineOptions result;
    given.take("error", result.error);
    given.take("max_edge", result.max_edge);
    given.take("min_edge", result.min_edge);
    given.take("max_vertices", result.max_vertices);
    given.take("curved", result.curved);
    given.take("bias", result.bias);
    return result;
}

PrecomputeOptions precompute_options(const Options& given) {
    PrecomputeOptions result;
    given.take("tolerance", result.tolerance);
    given.take("epsilon", result.epsilon);
    given.take("min_depth", result.min_level);
    given.take("face_resolution", result.face_resolution);
    given.take("bias", result.bias);
    if (one_of(given, "engine", {"beam", "embree"}) == 1)
        result.engine = Engine::Embree;
    // Python has made (kind, width, height, samples) of the text.
    if (const py::object receivers = given.given("receivers"); !receivers.is_none()) {
        const auto [kind, width, height, samples] =
            receivers.cast<std::tuple<std::string, std::uint32_t, std::uint32_t, std::uint32_t>>();
        if (kind == "pixels")
            result.receivers = Pixels{width, height, samples};
        else if (kind == "texels")
            result.receivers = Texels{width, height};
    }
    result.view = view_of(given);
    given.take("glossy_tolerance", result.glossy_tolerance);
    if (const py::object bounces = given.given("bounces"); py::isinstance<py::bool_>(bounces)) {
        if (bounces.cast<bool>())
            result.bounce_tolerance = prt::BounceOptions{}.tolerance;
    } else {
        given.take("bounces", result.bounce_tolerance);
    }
    given.take("two_sided", result.two_sided_bounces);
    given.take("max_memory", result.max_memory);
    if (const auto output = given.find<std::string>("output"))
        result.output = *output;
    given.take("checkpoint_seconds", result.checkpoint_seconds);
    given.take("resume", result.resume);
    return result;
}

OutputOptions output_options(const Options& given, const Scene& scene) {
    OutputOptions result;
    result.albedo = albedo_of(given);
    result.floor_albedo = given.color("floor_albedo");
    given.take("floor_fade", result.floor_fade);
    given.take("exposure", result.exposure_ev);
    if (result.exposure_ev && !(std::abs(*result.exposure_ev) <= 100.0))
        Options::refuse("exposure", "stops from -100 to 100", given.given("exposure"));
    if (const auto tone = given.find<std::string>("tone_map")) {
        const auto curve = relight::tone_curve(*tone);
        if (!curve)
            Options::refuse("tone_map", "neutral, agx, aces or none", given.given("tone_map"));
        result.tone = *curve;
    }
    if (const py::object size = given.given("size"); !size.is_none()) {
        try {
            std::tie(result.width, result.height) =
                size.cast<std::pair<std::uint32_t, std::uint32_t>>();
        } catch (const py::cast_error&) {
            Options::refuse("size", "(width, height)", size);
        }
        if (result.width < 1 || result.height < 1 || result.width > prt::MaxPictureSize ||
            result.height > prt::MaxPictureSize)
            Options::refuse("size",
                            "1 to " + std::to_string(prt::MaxPictureSize) + " pixels a side", size);
    }
    if (one_of(given, "sun", {"pixel", "vertex"}) == 1)
        result.sun = SunShadows::Receivers;
    result.background = background_of(given);
    if (const auto blur = given.find<double>("blur")) {
        if (!(*blur > 0.0 && *blur <= 180.0))
            Options::refuse("blur", "degrees of up to 180", given.given("blur"));
        result.background = EnvironmentBehind{.blur_degrees = *blur};
    }
    given.take("gutter", result.gutter);
    if (prt::on_vertices(scene.layout))
        result.camera = camera_of(
            given, scene, static_cast<float>(result.width) / static_cast<float>(result.height));
    return result;
}

std::vector<SurfaceMaterial> materials_of(const Options& given) {
    return materials_of(given.given("material"));
}

} // namespace relumine::python
