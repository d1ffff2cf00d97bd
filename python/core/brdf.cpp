#include "brdf.h"

#include <span>
#include <string_view>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "relumine/in/emission.h"
#include "run.h"

namespace relumine::python {

namespace {

using BrdfPointer = std::shared_ptr<Brdf>;

BrdfPointer loaded(const std::filesystem::path& path) {
    const Release release;
    return std::make_shared<Brdf>(Brdf{mesh::load_brdf(path)});
}

/// [N, 2, 3] directions to the light and to the eye.
Array questions() {
    const Release release;
    std::vector<float> numbers;
    for (const auto& [light, eye] : mesh::brdf_questions())
        numbers.insert(numbers.end(), {light.x, light.y, light.z, eye.x, eye.y, eye.z});
    const auto count = static_cast<py::ssize_t>(numbers.size() / 6);
    return owned(std::move(numbers), {count, 2, 3});
}

BrdfPointer from_answers(const py::buffer& answers) {
    const std::vector<glm::vec3> values = vec3s(answers);
    const Release release;
    return std::make_shared<Brdf>(Brdf{mesh::brdf_of(values)});
}

/// [90 * 90 * 90, 3] values at the places of a table.
BrdfPointer from_values(const py::buffer& array) {
    const std::vector<glm::vec3> colors = vec3s(array);
    const Release release;
    std::vector<float> values(3 * colors.size());
    for (std::size_t color = 0; color < 3; ++color)
        for (std::size_t i = 0; i < colors.size(); ++i)
            values[color * colors.size() + i] = colors[i][static_cast<int>(color)];
    return std::make_shared<Brdf>(Brdf{std::make_shared<const mesh::BrdfTable>(std::move(values))});
}

/// Vertical and horizontal angles, candela [horizontal, vertical], the flux, and what is left out.
py::tuple profile(const py::bytes& file) {
    const std::string_view text = file;
    const mesh::ReadLightProfile read =
        mesh::read_light_profile(std::as_bytes(std::span(text.data(), text.size())));
    const mesh::LightProfileTable& table = read.profile.table();
    const auto num_vertical = static_cast<py::ssize_t>(table.vertical.size());
    const auto num_horizontal = static_cast<py::ssize_t>(table.horizontal.size());
    return py::make_tuple(owned(std::vector(table.vertical), {num_vertical}),
                          owned(std::vector(table.horizontal), {num_horizontal}),
                          owned(std::vector(table.candela), {num_horizontal, num_vertical}),
                          read.profile.flux(), read.left_out);
}

} // namespace

void bind_brdfs(py::module_& module) {
    py::class_<Brdf, BrdfPointer>(module, "Brdf");
    module.def("load_brdf", &loaded);
    module.def("brdf_questions", &questions);
    module.def("brdf_of", &from_answers);
    module.def("brdf_table", &from_values);
    module.def("light_profile", &profile);
}

} // namespace relumine::python
