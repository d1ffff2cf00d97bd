#include "relumine/in/precompute_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "files/extension.h"
#include "files/joined.h"
#include "prt/glossy/lobe_list.h"
#include "prt/receivers/point_receivers.h"

namespace relumine {

namespace {

/// A material as text. Values are read as they are met.
struct Parser {
    const std::string& text;
    prt::Highlight highlight = prt::Highlight::None;
    const prt::LobeFacts* model = nullptr;
    std::size_t start_of_model = 0;
    std::map<std::string_view, std::vector<float>> values = {};

    /// Group names may have any letters: the model is looked for behind the last = that a model's
    /// name follows.
    void find_model() {
        for (std::size_t start = text.size() + 1; start-- > 0;) {
            if (start > 0 && text[start - 1] != '=')
                continue;
            const std::string name = split(text.substr(std::min(start, text.size())), ':').front();
            for (std::size_t i = 0; i < prt::NumHighlights; ++i) {
                highlight = static_cast<prt::Highlight>(i);
                model = &prt::facts_of(highlight);
                start_of_model = start;
                if (model->name == name)
                    return;
            }
        }
        std::vector<std::string> forms;
        for (std::size_t i = 1; i <= prt::NumHighlights; ++i) // lambert last
            forms.push_back(fmt::format(
                "[GROUP=]{}:...",
                prt::facts_of(static_cast<prt::Highlight>(i % prt::NumHighlights)).name));
        refuse_text(files::joined_by_or(forms), text);
    }

    /// key=number,number,number,key=number
    void read_values(const std::string& list) {
        std::vector<std::string_view> keys = {model->albedo, model->specular, model->shape};
        std::erase(keys, "");
        const std::string form = fmt::format("{}:NAME=VALUE,...", model->name);
        for (const auto& [name, value] : named_texts(list, form, text)) {
            const auto key = std::find(keys.begin(), keys.end(), name);
            if (key == keys.end())
                refuse_text(fmt::format("{} of {}", files::joined(keys, ", "), model->name), name);
            if (values.contains(*key))
                refuse_text(fmt::format("{} once", *key), text);
            const float max = *key == model->shape ? model->largest_shape : 1.0f;
            std::vector<float>& numbers = values[*key];
            for (const std::string& number : split(value, ',')) {
                if (number.empty() && !numbers.empty())
                    refuse_text(form, text);
                const auto read = parse_number(number);
                if (!read || !(*read >= 0.0 && *read <= double{max}))
                    refuse_text(fmt::format("numbers of 0 to {} as {}", max, *key), number);
                numbers.push_back(static_cast<float>(option_text::real(number, 1e6)));
            }
        }
    }

    [[nodiscard]] std::optional<glm::vec3> color(std::string_view key) const {
        const auto found = values.find(key);
        if (found == values.end())
            return std::nullopt;
        const std::vector<float>& numbers = found->second;
        if (numbers.size() != 1 && numbers.size() != 3)
            refuse_text(fmt::format("1 or 3 numbers of {}", key),
                        fmt::format("{}", fmt::join(numbers, ",")));
        return numbers.size() == 1 ? glm::vec3(numbers[0])
                                   : glm::vec3(numbers[0], numbers[1], numbers[2]);
    }

    /// brdf:FILE
    [[nodiscard]] SurfaceMaterial measured(const std::string& file) const {
        if (file.empty())
            refuse_text(fmt::format("{}:FILE, a .binary file", model->name), text);
        return {
            .group = group(), .highlight = highlight, .table = mesh::load_brdf(file), .file = file};
    }

    [[nodiscard]] std::string group() const {
        return text.substr(0, start_of_model > 0 ? start_of_model - 1 : 0);
    }

    SurfaceMaterial parse() {
        find_model();
        if (start_of_model == 1)
            refuse_text("a group's name before =", text);
        const std::size_t end = start_of_model + model->name.size() + 1;
        if (model->is_table)
            return measured(text.substr(std::min(end, text.size())));
        if (end < text.size())
            read_values(text.substr(end));
        SurfaceMaterial result{.group = group(),
                               .highlight = highlight,
                               .albedo = color(model->albedo),
                               .specular = color(model->specular)};
        if (!model->shape.empty()) {
            if (values[model->shape].size() != 1)
                refuse_text(fmt::format("one number of {} of {}", model->shape, model->name), text);
            result.roughness_or_exponent = values[model->shape].front();
        }
        if (model->needs_specular) {
            if (!result.specular)
                refuse_text(fmt::format("{} of {}", model->specular, model->name), text);
            const glm::vec3 sum = result.albedo.value_or(glm::vec3(0.0f)) + *result.specular;
            if (std::max({sum.r, sum.g, sum.b}) > 1.0f + 1e-6f)
                refuse_text(fmt::format("{} + {} of 1 or less", model->albedo, model->specular),
                            text);
        }
        return result;
    }
};

constexpr const char* ReceiversForms =
    "vertices, pixels:WxH, pixels:WxH:N, texels:WxH, points:FILE, grid:NXxNYxNZ or "
    "grid:NXxNYxNZ:X0,Y0,Z0,X1,Y1,Z1";

Points read_points(const std::string& text) {
    Points points{.file = text.substr(text.find(':') + 1)};
    const std::string extension = files::extension_of(points.file);
    if (extension != ".npy" && extension != ".ply")
        refuse_text("a .npy or .ply file of points", text);
    return points;
}

Grid read_grid(const std::string& text) {
    const std::vector<std::string> parts = split(text, ':');
    if (parts.size() > 3)
        refuse_text(ReceiversForms, text);
    const std::vector<std::string> sides = split(parts[1], 'x');
    std::array<std::uint32_t, 3> cells{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto count = sides.size() == cells.size() ? parse_count(sides[i]) : std::nullopt;
        if (!count)
            refuse_text(ReceiversForms, text);
        cells[i] = *count;
    }
    Grid grid{.nx = cells[0], .ny = cells[1], .nz = cells[2]};
    if (parts.size() == 3)
        grid.box = BoxText::read(parts[2]);
    check(grid);
    return grid;
}

bool is_size(std::uint32_t side) {
    return side >= 1 && side <= prt::MaxPictureSize;
}

} // namespace

ReceiversText::Value ReceiversText::read(const std::string& text) {
    if (text == "vertices")
        return Vertices{};
    if (text.starts_with("points:"))
        return read_points(text);
    if (text.starts_with("grid:"))
        return read_grid(text);
    // KIND:SIZE, for pixels also KIND:SIZE:SAMPLES.
    const std::vector<std::string> parts = split(text, ':');
    const bool are_pixels = parts[0] == "pixels";
    const auto size = parts.size() > 1 ? parse_sides(parts[1]) : std::nullopt;
    const auto samples = parts.size() > 2 ? parse_count(parts[2]) : std::nullopt;
    if ((!are_pixels && parts[0] != "texels") || !size || (parts.size() > 2 && !samples) ||
        parts.size() > (are_pixels ? 3 : 2))
        refuse_text(ReceiversForms, text);
    const auto [width, height] = *size;
    if (!is_size(width) || !is_size(height))
        refuse_text(fmt::format("a size of 1 to {} a side", prt::MaxPictureSize), text);
    if (samples && (*samples < 1 || *samples > prt::MaxSamplesPerAxis))
        refuse_text(fmt::format("1 to {} samples a side", prt::MaxSamplesPerAxis), text);
    const std::size_t per_axis =
        samples.value_or(are_pixels ? prt::PixelLayout::EdgeSamplesPerAxis : 1);
    if (std::size_t{width} * height * per_axis * per_axis > prt::MaxLayoutPlaces)
        refuse_text(fmt::format("at most {} samples in all, {} x {} a pixel", prt::MaxLayoutPlaces,
                                per_axis, per_axis),
                    text);
    if (!are_pixels)
        return Texels{.width = width, .height = height};
    return Pixels{.width = width, .height = height, .samples_per_axis = samples};
}

std::string ReceiversText::show(const Value& receivers) {
    if (const auto* pixels = std::get_if<Pixels>(&receivers))
        return fmt::format("pixels:{}x{}", pixels->width, pixels->height) +
               (pixels->samples_per_axis ? fmt::format(":{}", *pixels->samples_per_axis) : "");
    if (const auto* texels = std::get_if<Texels>(&receivers))
        return fmt::format("texels:{}x{}", texels->width, texels->height);
    if (const auto* points = std::get_if<Points>(&receivers))
        return fmt::format("points:{}", points->file.string());
    if (const auto* grid = std::get_if<Grid>(&receivers))
        return fmt::format("grid:{}x{}x{}", grid->nx, grid->ny, grid->nz) +
               (grid->box ? ":" + BoxText::show(*grid->box) : "");
    return "vertices";
}

PlacedBox BoxText::read(const std::string& text) {
    const auto numbers = parse_numbers(text);
    if (!numbers || numbers->size() != 6)
        refuse_text("X0,Y0,Z0,X1,Y1,Z1", text);
    const std::vector<double>& values = *numbers;
    const PlacedBox box({values[0], values[1], values[2]}, {values[3], values[4], values[5]});
    for (int axis = 0; axis < 3; ++axis)
        if (!(box.min[axis] <= box.max[axis] && box.min[axis] >= -LargestPosition &&
              box.max[axis] <= LargestPosition))
            refuse_text(fmt::format("the lower corner first, within {}", LargestPosition), text);
    return box;
}

std::string BoxText::show(const PlacedBox& box) {
    return fmt::format("{},{}", PointText::show(box.min), PointText::show(box.max));
}

View ViewText::read(const std::string& text) {
    if (text == "auto")
        return View{};
    const auto numbers = parse_numbers(text);
    const auto is_near = [](double number) {
        return std::abs(number) <= LargestPosition;
    };
    if (!numbers || (numbers->size() != 6 && numbers->size() != 7) ||
        !std::all_of(numbers->begin(), numbers->end(), is_near))
        refuse_text(fmt::format("auto or EX,EY,EZ,TX,TY,TZ[,FOV] within {}", LargestPosition),
                    text);
    const std::vector<double>& values = *numbers;
    PlacedCamera camera;
    camera.eye = {values[0], values[1], values[2]};
    camera.target = {values[3], values[4], values[5]};
    if (values.size() == 7)
        camera.fov_degrees = static_cast<float>(values[6]);
    prt::Camera ahead{.target = glm::vec3(camera.target - camera.eye),
                      .fov_degrees = camera.fov_degrees};
    static_cast<void>(prt::axes_of(ahead, 1.0f)); // which checks it
    return View{camera};
}

std::string ViewText::show(const View& view) {
    return view.camera ? fmt::format("{},{},{}", PointText::show(view.camera->eye),
                                     PointText::show(view.camera->target), view.camera->fov_degrees)
                       : "auto";
}

std::uint64_t MemoryText::read(const std::string& text) {
    constexpr std::string_view Units = "BKMGT";
    const std::size_t end = std::min(text.find_first_not_of("0123456789."), text.size());
    const std::optional<double> number = parse_number(text.substr(0, end));
    const std::string unit = text.substr(end);
    if (number && unit.empty())
        throw std::invalid_argument(
            fmt::format("expected a unit after the number, as in {0}M or {0}G, got '{0}'", text));
    const std::size_t power =
        unit.empty()
            ? std::string_view::npos
            : Units.find(static_cast<char>(std::toupper(static_cast<unsigned char>(unit.front()))));
    const bool is_unit =
        power != std::string_view::npos &&
        (unit.size() == 1 || (power != 0 && (unit.substr(1) == "B" || unit.substr(1) == "iB")));
    const double bytes =
        number && is_unit ? *number * std::exp2(10.0 * static_cast<double>(power)) : 0.0;
    if (!(bytes >= 1.0 && bytes < 1e18))
        refuse_text("a size like 500M or 4G", text);
    return static_cast<std::uint64_t>(bytes);
}

SurfaceMaterial MaterialText::read(const std::string& text) {
    return Parser{text}.parse();
}

std::string MaterialText::show(const SurfaceMaterial& material) {
    const prt::LobeFacts& model = prt::facts_of(material.highlight);
    std::vector<std::string> values;
    if (material.table)
        values.push_back(material.file);
    if (material.albedo)
        values.push_back(fmt::format("{}={}", model.albedo, ColorText::show(*material.albedo)));
    if (material.specular)
        values.push_back(fmt::format("{}={}", model.specular, ColorText::show(*material.specular)));
    if (!model.shape.empty())
        values.push_back(fmt::format("{}={}", model.shape, material.roughness_or_exponent));
    return fmt::format("{}{}{}{}{}", material.group, material.group.empty() ? "" : "=", model.name,
                       values.empty() ? "" : ":", files::joined(values, ","));
}

OptionRow material_row(std::vector<SurfaceMaterial>& materials) {
    return row<MaterialText>(
        "--material", materials,
        "surface in place of the file's: ggx:roughness=0.3,albedo=0.5,f0=0.04, "
        "blinn:exponent=50,kd=0.3,ks=0.2, lambert:albedo=0.8 or brdf:FILE (a measured BRDF, "
        ".binary "
        "of the MERL database); GROUP=... for one object; "
        "the floor of --floor is `floor`, and Lambert unless named");
}

OptionTable options_of(PrecomputeOptions& o) {
    return {
        row("--tolerance", o.tolerance,
            fmt::format(
                "RMS error of the transfer allowed within a cluster, 1/sr ({}; {} where "
                "the mesh or its floor is refined by itself, and for pixels; {} for points; "
                "unless given, more where there would be many clusters of pixels, or glass)",
                prt::PrecomputeOptions{}.tolerance, ToleranceOfRefined, ToleranceOfPoints),
            {.min = 0, .max = 1e6}),
        row("--epsilon", o.epsilon,
            "the paper's form of the tolerance: grows lax with the mesh's size",
            {.min = 0, .max = 1e6, .excludes = "--tolerance", .library_only = true}),
        row("--min-depth", o.min_level,
            fmt::format("every cell is split at least this often; for points at least {} times",
                        prt::MinLevelOfPoints),
            {.min = 0, .max = prt::MaxLevel, .library_only = true}),
        row("--face-resolution", o.face_resolution,
            "R: cells stop at single texels of a 6 x R x R environment",
            {.min = 1, .max = 1u << prt::MaxLevel}),
        row("--bias", o.bias, "lift of the rays' origins off the surface, in the mesh's unit",
            {.min = 0, .max = LargestPosition, .library_only = true}),
        row<ReceiversText>("--receivers", o.receivers,
                           "what is lit: vertices, pixels:WxH[:N] (of --view, N x N samples "
                           "each), texels:WxH (a lightmap on the mesh's uvs), points:FILE (.npy, "
                           ".ply: points in space) or grid:NXxNYxNZ[:X0,Y0,Z0,X1,Y1,Z1] (the "
                           "middles of the cells of a box; without it of the mesh's, without its "
                           "floor)",
                           {.example = "texels:64x32"}),
        row("--no-refine", o.no_refine,
            "keep the mesh's vertices; otherwise a coarse mesh gets more where its light needs "
            "them",
            {.library_only = true}), // --refine off
        row<ViewText>("--view", o.view,
                      "the camera of pixels, and the eye that highlights are for: "
                      "EX,EY,EZ,TX,TY,TZ[,FOV] (eye, target, vertical degrees: 35) or auto",
                      {.example = "0,1,5,0,0,0,40"}),
        row("--ggx", o.ggx,
            "highlights of materials with roughness: whole (what scatters between the facets comes "
            "back, and a white surface stays white), or published (glTF's formula)",
            {.library_only = true}),
        row("--highlights", o.highlights,
            "stored in the scene, exact and free of noise, or traced: rays find them when pixels "
            "are lit (by default pixels trace them, vertices and texels store them)"),
        row("--glossy-tolerance", o.glossy_tolerance,
            "relative error of a stored highlight under a small light anywhere",
            {.min = 1e-4, .max = 1}),
        row<MemoryText>("--max-memory", o.max_memory,
                        "refuse the work when it would take more memory, stop when it does: "
                        "500M, 4G",
                        {.example = "4G"}),
        row("--bounces", o.bounce_tolerance,
            "light goes on from surface to surface; the standard error of one bounce under a "
            "sun or a white sky of radiance 1, 0.01 when it is not given; 0: direct light "
            "alone. Without the option vertices bounce light where they see other surfaces",
            {.min = 0,
             .max = 1,
             .type = "[ERROR]",
             .bare = fmt::format("{}", prt::BounceOptions{}.tolerance)}),
        row("--two-sided", o.two_sided_bounces,
            "backs of surfaces send the bounced light that their fronts do",
            {.needs = "--bounces"}),
        row("--movable", o.movable,
            "keep the groups of the mesh (nodes of glTF, groups of OBJ) in the scene, so that they "
            "can be moved: relumine move"),
        row("--resume", o.resume,
            "go on from the last checkpoint of the same work, SCENE.prt.checkpoint, where "
            "there is one; without it the work begins anew and its checkpoints replace that "
            "one"),
        row("--checkpoint-seconds", o.checkpoint_seconds,
            "time between two checkpoints; 0: none. The last goes away when the scene is "
            "written",
            {.min = 0, .max = 86400})};
}

void check(const Grid& grid) {
    const std::size_t num_rows = std::size_t{grid.ny} * grid.nz;
    if (grid.nx < 1 || num_rows < 1 || grid.nx > prt::MaxPictureSize ||
        grid.ny > prt::MaxPictureSize || grid.nz > prt::MaxPictureSize ||
        num_rows > prt::MaxPictureSize || num_rows * grid.nx > prt::MaxPoints)
        throw std::invalid_argument(
            fmt::format("expected a grid of 1 to {} points, and at most {} of them along x or in "
                        "a slice across it, got {} x {} x {}",
                        prt::MaxPoints, prt::MaxPictureSize, grid.nx, grid.ny, grid.nz));
}

void check(const PrecomputeOptions& options) {
    if (std::holds_alternative<Pixels>(options.receivers) && !options.view)
        throw OptionError("--receivers", "expected --view (a camera, or auto) with pixels");
    if (options.highlights == Highlights::Traced &&
        !std::holds_alternative<Pixels>(options.receivers))
        throw OptionError("--highlights", "expected --receivers pixels:WxH with traced highlights");
    check_points(options);
}

void check_points(const PrecomputeOptions& options) {
    const bool is_grid = std::holds_alternative<Grid>(options.receivers);
    if (!is_grid && !std::holds_alternative<Points>(options.receivers))
        return;
    if (options.view)
        throw OptionError("--view", "expected none with points, which no eye sees");
}

void set_materials(PrecomputeOptions& options, std::span<const SurfaceMaterial> materials,
                   const mesh::TriangleMesh& mesh) {
    for (const SurfaceMaterial& material : materials)
        if (material.group == "floor")
            options.floor_surface = material.applied_to({});
    if (materials.empty())
        return;
    try {
        options.surface = surface_override(materials, mesh);
    } catch (const std::invalid_argument& error) {
        throw OptionError("--material", error.what());
    }
}

} // namespace relumine
