// Scenes in light.
#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "blockers.h"
#include "files/json_reader.h"
#include "files/one_of_each.h"
#include "lights.h"
#include "options.h"
#include "relumine/ask/fit.h"
#include "relumine/light/harmonics_file.h"
#include "relumine/light/layers.h"
#include "relumine/light/light_lists.h"
#include "relumine/light/light_parts.h"
#include "relumine/light/live_eye.h"
#include "relumine/light/scene_moves.h"
#include "relumine/out/pictures.h"
#include "run.h"
#include "scene.h"

namespace relumine::python {

namespace {

using Path = std::filesystem::path;

/// A LitScene that any thread may call, one after the other. Its radiance is copied after each
/// change into memory that stays where it is as long as Python looks at it.
class Lit {
public:
    /// A scene whose groups may move is copied: Python's never change.
    Lit(std::shared_ptr<const Scene> scene, const LightOptions& options)
        : lit_(scene->settings.is_movable ? LitScene(Scene(*scene), options)
                                          : LitScene(std::move(scene), options)),
          radiance_(lit_.scene().receivers.size()) {}

    /// Returns `work(LitScene&)`; other threads wait. Called without Python's lock.
    template<typename Work>
    auto use(const Work& work) {
        const std::lock_guard lock(mutex_);
        is_eye_lit_ = false;
        return work(lit_);
    }
    /// Returns what goes to an eye, highlights included.
    std::vector<glm::vec3> towards(const glm::vec3& eye, const EyeOptions& options) {
        const std::lock_guard lock(mutex_);
        if (!eye_)
            eye_.emplace(lit_);
        else if (!is_eye_lit_)
            eye_->take_light();
        is_eye_lit_ = true;
        const std::span<const glm::vec3> radiance = eye_->look(eye, options);
        return {radiance.begin(), radiance.end()};
    }
    /// Returns `work(LitScene&)` that changes the light, and copies the radiance, also where it
    /// throws; other threads wait. Called without Python's lock.
    template<typename Work>
    auto change(const Work& work) {
        const std::lock_guard lock(mutex_);
        is_eye_lit_ = false;
        struct Copies {
            ~Copies() { own.copy_radiance(); }
            Lit& own;
        };
        const Copies copies{*this};
        return work(lit_);
    }
    /// Returns `work(LitScene&)` that moves groups.
    template<typename Work>
    auto move(const Work& work) {
        return change([&](LitScene& lit) {
            eye_.reset();
            return work(lit);
        });
    }
    /// A progress function that calls back would wait for itself.
    void refuse_reentry() const {
        if (std::find(waiting_.begin(), waiting_.end(), this) != waiting_.end())
            throw std::runtime_error("relighter: expected no call from its own progress function");
    }
    [[nodiscard]] bool is_lit() const { return is_lit_; }
    [[nodiscard]] std::span<const glm::vec3> radiance() const { return radiance_; }
    [[nodiscard]] const Scene& scene() const { return lit_.scene(); }

    /// Notes that this thread waits for a job.
    class Caller {
    public:
        explicit Caller(const Lit& own) { waiting_.push_back(&own); }
        Caller(const Caller&) = delete;
        Caller& operator=(const Caller&) = delete;
        ~Caller() { waiting_.pop_back(); }
    };

private:
    void copy_radiance() {
        const std::span<const glm::vec3> radiance = lit_.radiance();
        std::copy(radiance.begin(), radiance.end(), radiance_.begin());
        is_lit_ = !radiance.empty();
    }

    std::mutex mutex_;
    LitScene lit_;
    std::vector<glm::vec3> radiance_;
    std::atomic<bool> is_lit_ = false;
    /// Once it was asked for.
    std::optional<LiveEye> eye_;
    /// Whether it has the present light.
    bool is_eye_lit_ = false;
    /// What this thread waits for, one within the other.
    static inline thread_local std::vector<const Lit*> waiting_;
};

using LitPointer = std::shared_ptr<Lit>;

template<typename Work>
auto quickly(Lit& own, const Work& work) {
    own.refuse_reentry();
    const Release release;
    return own.use(work);
}

template<typename Work>
auto change(Lit& own, const Work& work) {
    own.refuse_reentry();
    const Release release;
    return own.change(work);
}

/// `work(LitScene&, reins)` owns all that it uses.
template<typename Work>
auto slowly(const LitPointer& own, const py::object& progress, Work work) {
    own->refuse_reentry();
    const Lit::Caller caller(*own);
    return in_background(progress, [own, work = std::move(work)](const Reins& reins) {
        return own->use([&](LitScene& lit) { return work(lit, reins); });
    });
}

/// The same with `work(LitScene&, reins)` that moves groups.
template<typename Work>
auto moving(const LitPointer& own, const py::object& progress, Work work) {
    own->refuse_reentry();
    const Lit::Caller caller(*own);
    return in_background(progress, [own, work = std::move(work)](const Reins& reins) {
        return own->move([&](LitScene& lit) { return work(lit, reins); });
    });
}

py::tuple update_of(const UpdateReport& report) {
    return py::make_tuple(report.num_clusters, report.num_receivers, report.num_sharp_lights,
                          report.seconds, report.seconds_trace, report.resummed);
}

py::tuple times_of(const UpdateReport& times) {
    return py::make_tuple(times.seconds_bin, times.seconds_relight, times.seconds_trace,
                          times.num_sharp_lights);
}

/// A JSON array of layers. Pictures that they name are looked for in the present folder.
std::vector<cubemap::LightLayer> layers_of(const std::string& json) {
    const files::JsonReader reader("layers");
    const files::Json list = reader.parse(std::as_bytes(std::span(json)));
    return cubemap::read_layers(reader, list, {});
}

/// Returns layers_of(), with the error that belongs to arguments.
std::vector<cubemap::LightLayer> checked_layers(const std::string& json) {
    try {
        return layers_of(json);
    } catch (const std::runtime_error& error) {
        throw std::invalid_argument(error.what());
    }
}

py::tuple set_lights(Lit& own, const py::buffer& directions, const py::buffer& irradiances,
                     const py::buffer& solid_angles) {
    auto list = lights_of(directions, irradiances, solid_angles);
    return times_of(change(own, [&](LitScene& lit) { return lit.light(std::move(list)); }));
}

py::tuple update_region(Lit& own, unsigned face, std::uint32_t x, std::uint32_t y,
                        std::uint32_t width, std::uint32_t height, const py::buffer& radiance) {
    if (face >= cubemap::NumFaces)
        throw py::value_error("face: expected 0 to 5 (+x -x +y -y +z -z)");
    const std::vector<glm::vec3> values = vec3s(radiance);
    const cubemap::TexelRectangle rectangle{static_cast<cubemap::Face>(face), x, y, x + width,
                                            y + height};
    return update_of(change(
        own, [&](LitScene& lit) { return lit.environment().update_region(rectangle, values); }));
}

py::tuple set_layers(Lit& own, const std::string& json) {
    return update_of(change(
        own, [&](LitScene& lit) { return relumine::set_layers(lit, checked_layers(json)); }));
}

/// `json`: a list with one layer.
py::tuple set_layer(Lit& own, std::size_t index, const std::string& json) {
    return update_of(change(own, [&](LitScene& lit) {
        return relumine::set_layer(lit, index, checked_layers(json).at(0));
    }));
}

/// The shapes of layers: name, what they are, and of each field the name, what it holds, and the
/// default or None.
py::list layer_shapes() {
    py::list result;
    for (cubemap::Region& shape : files::one_of_each<cubemap::Region>()) {
        py::list all;
        for (const cubemap::LayerField& field : cubemap::fields(shape)) {
            py::object value = py::none();
            if (!field.required)
                value = py::float_(values(field)[0]);
            all.append(py::make_tuple(std::string(field.name),
                                      field.points != nullptr      ? "points"
                                      : field.direction != nullptr ? "direction"
                                                                   : "number",
                                      value));
        }
        const cubemap::ShapeWords& words = cubemap::words(shape);
        result.append(py::make_tuple(std::string(words.name), std::string(words.about), all));
    }
    return result;
}

std::string layers_text(Lit& own) {
    return quickly(own, [](LitScene& lit) {
        return cubemap::json_text({.layers = lit.environment().state().layers});
    });
}

void mark(Lit& own) {
    // A mark sums the light anew, so the last bits of it may change.
    change(own, [](LitScene& lit) {
        if (!has_environment(lit))
            throw std::invalid_argument("mark: expected an environment, got none");
        relumine::mark(lit);
        return true;
    });
}

void bind_editing(py::class_<Lit, LitPointer>& type) {
    type.def("update_region", &update_region)
        .def("set_layers", &set_layers)
        .def("set_layer", &set_layer)
        .def("layers", &layers_text)
        .def("set_rotation",
             [](Lit& own, double degrees, bool moving) {
                 return update_of(change(own, [&](LitScene& lit) {
                     return relumine::set_rotation(lit, degrees,
                                                   moving ? Ending::Moving : Ending::Quick);
                 }));
             })
        .def("mark", &mark)
        .def("undo", [](Lit& own) { return update_of(change(own, &relumine::undo)); })
        .def("redo", [](Lit& own) { return update_of(change(own, &relumine::redo)); })
        .def("history", [](Lit& own) {
            return quickly(own, [](LitScene& lit) {
                return std::pair(lit.environment().history().can_undo(lit.environment().state()),
                                 lit.environment().history().can_redo());
            });
        });
}

py::dict move(const LitPointer& own, const py::dict& moves, const py::object& progress) {
    return move_figures(
        moving(own, progress, [to = group_moves(moves)](LitScene& lit, const Reins& reins) {
            return lit.moves().move(to, move_work(reins));
        }));
}

py::dict drag(const LitPointer& own, const std::string& name, const py::object& to) {
    return move_figures(
        moving(own, py::none(), [to = group_move(name, to)](LitScene& lit, const Reins&) {
            return lit.moves().drag(to);
        }));
}

/// A copy of the scene as it stands.
std::shared_ptr<Scene> present_scene(const LitPointer& own) {
    return slowly(own, py::none(), [](LitScene& lit, const Reins&) {
        if (lit.moves().is_dragging())
            throw std::logic_error(
                "expected no group that is dragged: drop() or undo_move() first");
        return std::make_shared<Scene>(lit.scene());
    });
}

void bind_moves(py::class_<Lit, LitPointer>& type) {
    type.def("move", &move)
        .def("drag", &drag)
        .def("drop",
             [](const LitPointer& own, const py::object& progress) {
                 return move_figures(moving(own, progress, [](LitScene& lit, const Reins& reins) {
                     return lit.moves().drop(move_work(reins));
                 }));
             })
        .def("exchange_move",
             [](const LitPointer& own, bool is_undo) {
                 return moving(own, py::none(), [is_undo](LitScene& lit, const Reins&) {
                     return is_undo ? lit.moves().undo() : lit.moves().redo();
                 });
             })
        .def("scene", &present_scene);
}

py::dict verify(const LitPointer& own, std::size_t samples, std::size_t surface, std::uint64_t seed,
                std::uint32_t paths, const py::object& progress) {
    Verification found = slowly(own, progress, [=](LitScene& lit, const Reins& reins) {
        return relumine::verify(lit,
                                {.num_samples = samples,
                                 .seed = seed,
                                 .num_surface_points = surface,
                                 .num_paths = paths},
                                reins);
    });
    py::dict result;
    result["relative_l2"] = found.error.relative_l2;
    result["mean_abs"] = found.error.mean_abs;
    result["max_abs"] = found.error.max_abs;
    result["bias"] = found.error.bias;
    result["mean_radiance"] = found.error.mean_radiance;
    result["worst_receiver"] = found.error.worst_receiver;
    result["noise"] = found.noise;
    result["of_file"] = found.of_file;
    const WorstError worst = worst_of(found);
    result["worst"] = worst.relative_l2;
    result["worst_place"] = std::string(worst.place);
    result["receivers"] = owned(std::move(found.receivers));
    return result;
}

py::tuple lit_by(const LitPointer& own, const std::string& json) {
    const std::vector<cubemap::LightLayer> layers = checked_layers(json);
    Share share =
        slowly(own, py::none(), [region = layers.at(0).region](LitScene& lit, const Reins&) {
            return relumine::lit_by(lit, region);
        });
    return py::make_tuple(owned(std::move(share.radiance)), owned(std::move(share.environment)),
                          share.share);
}

Array contribution_map(const LitPointer& own, const py::buffer& receivers) {
    cubemap::CubeMap map =
        slowly(own, py::none(), [chosen = uint32s(receivers)](LitScene& lit, const Reins&) {
            return relumine::contribution_map(lit, chosen);
        });
    return owned(std::move(map));
}

Array adjoint(const LitPointer& own, const py::buffer& weights) {
    const std::vector<glm::vec3> values = vec3s(weights);
    cubemap::CubeMap map =
        quickly(*own, [&](LitScene& lit) { return relumine::adjoint(lit, values); });
    return owned(std::move(map));
}

/// `texels` is [6, R, R, 3]; returns [height, width, 3].
Array lat_long_adjoint(const py::buffer& texels, std::uint32_t resolution, std::uint32_t width,
                       std::uint32_t height) {
    cubemap::CubeMap map(resolution);
    const std::vector<glm::vec3> values = vec3s(texels);
    std::copy(values.begin(), values.end(), map.texels.begin());
    std::vector<glm::vec3> pixels;
    {
        const Release release;
        pixels = relumine::lat_long_adjoint(map, width, height);
    }
    return owned(std::move(pixels), {height, width});
}

/// `weights` is [num_receivers * order^2, 3].
Array harmonics_adjoint(const LitPointer& own, const py::buffer& weights) {
    const std::vector<glm::vec3> values = vec3s(weights);
    cubemap::CubeMap map =
        quickly(*own, [&](LitScene& lit) { return relumine::harmonics_adjoint(lit, values); });
    return owned(std::move(map));
}

/// `cubes` is [B, 6, R, R, 3]; returns [B, num_receivers, 3].
Array relight_batch(const LitPointer& own, const py::buffer& cubes, std::size_t count,
                    std::uint32_t resolution) {
    const std::vector<glm::vec3> texels = vec3s(cubes);
    std::vector<cubemap::CubeMap> maps(count, cubemap::CubeMap(resolution));
    const auto per_map = static_cast<std::ptrdiff_t>(texels.size() / count);
    for (std::size_t i = 0; i < count; ++i)
        std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(i) * per_map, per_map,
                    maps[i].texels.begin());
    const std::size_t num_receivers = own->scene().receivers.size();
    std::vector<glm::vec3> radiance(count * num_receivers);
    quickly(*own, [&](LitScene& lit) {
        relumine::relight_batch(lit, maps, radiance);
        return true;
    });
    return owned(std::move(radiance),
                 {static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(num_receivers)});
}

/// [num_receivers, num_points]: 1 where a point is seen.
Array sees(const LitPointer& own, const py::buffer& points) {
    std::vector<glm::vec3> places = vec3s(points);
    const Shape shape = {static_cast<py::ssize_t>(own->scene().receivers.size()),
                         static_cast<py::ssize_t>(places.size())};
    return owned(slowly(own, py::none(),
                        [places = std::move(places)](LitScene& lit, const Reins&) {
                            return relumine::sees(lit, places);
                        }),
                 shape);
}

LightArrays transfer_lights(const LitPointer& own, std::size_t number, const py::object& progress) {
    return arrays_of(slowly(own, progress, [number](LitScene& lit, const Reins& reins) {
        return relight::transfer_lights(lit.relighter(), number, reins);
    }));
}

void bind_questions(py::class_<Lit, LitPointer>& type) {
    type.def("verify", &verify)
        .def("lit_by", &lit_by)
        .def("contribution_map", &contribution_map)
        .def("adjoint", &adjoint)
        .def("harmonics_adjoint", &harmonics_adjoint)
        .def("relight_batch", &relight_batch)
        .def("sees", &sees)
        .def("transfer_lights", &transfer_lights);
}

/// `weights` is [height * width, 3].
Array picture_adjoint(const LitPointer& own, const py::buffer& weights, std::uint32_t height,
                      std::uint32_t width, const py::dict& given) {
    const std::vector<glm::vec3> values = vec3s(weights);
    const auto* pixels = std::get_if<prt::PixelLayout>(&own->scene().layout);
    if (pixels != nullptr && (pixels->height != height || pixels->width != width))
        throw py::value_error(fmt::format("weights: expected shape ({}, {}, 3), got ({}, {}, 3)",
                                          pixels->height, pixels->width, height, width));
    const OutputOptions options = options_from<OutputOptions>(given);
    cubemap::CubeMap map = quickly(
        *own, [&](LitScene& lit) { return relumine::picture_adjoint(lit, values, options); });
    return owned(std::move(map));
}

/// Returns [height, width, 3 or 4] and the exposure that suits it.
py::tuple draw(const LitPointer& own, const py::dict& given) {
    const OutputOptions options = options_from<OutputOptions>(given);
    auto [picture, exposure] = slowly(own, py::none(), [options](LitScene& lit, const Reins&) {
        lit.dim(options.emission);
        Painter painter(lit, options);
        const Lighting lighting = lit.lighting();
        Picture drawn = painter.draw(lighting);
        return std::pair(std::move(drawn), painter.choose_exposure_ev(lighting));
    });
    const Shape size = {picture.height, picture.width};
    if (picture.alpha.empty())
        return py::make_tuple(owned(std::move(picture.pixels), size), exposure);
    std::vector<float> rgba;
    rgba.reserve(4 * picture.pixels.size());
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        rgba.insert(rgba.end(), {picture.pixels[i].r, picture.pixels[i].g, picture.pixels[i].b,
                                 picture.alpha[i]});
    return py::make_tuple(owned(std::move(rgba), {size[0], size[1], 4}), exposure);
}

void save_lit(const LitPointer& own, const Path& path, const py::dict& given) {
    slowly(own, py::none(),
           [path, options = options_from<OutputOptions>(given)](LitScene& lit, const Reins&) {
               lit.dim(options.emission);
               save(lit, path, options);
               return true;
           });
}

/// A PNG or EXR file of an array.
relight::Picture picture_of(const py::buffer& pixels, std::uint32_t width, std::uint32_t height,
                            const py::object& alpha) {
    relight::Picture result{.width = width, .height = height, .pixels = vec3s(pixels)};
    if (!alpha.is_none()) {
        const py::buffer_info info = alpha.cast<py::buffer>().request();
        const auto* values = static_cast<const float*>(info.ptr);
        if (info.format != "f" || info.itemsize != sizeof(float))
            throw py::type_error("expected float32 alpha");
        result.alpha.assign(values, values + info.size);
    }
    return result;
}

relight::Development development(double exposure, const std::string& tone) {
    relight::Development result{.exposure_ev = exposure};
    row("--tone-map", result.tone, "").set(tone);
    return result;
}

void bind_pictures(py::module_& module, py::class_<Lit, LitPointer>& type) {
    type.def("draw", &draw).def("save", &save_lit).def("picture_adjoint", &picture_adjoint);
    module.def("picture_png",
               [](const py::buffer& pixels, std::uint32_t width, std::uint32_t height,
                  const py::object& alpha, double exposure, const std::string& tone) {
                   const relight::Picture picture = picture_of(pixels, width, height, alpha);
                   const relight::Development how = development(exposure, tone);
                   std::vector<std::byte> file;
                   {
                       const Release release;
                       file = relight::png_file(picture, how);
                   }
                   return py::bytes(reinterpret_cast<const char*>(file.data()), file.size());
               });
    module.def("save_picture", [](const Path& path, const py::buffer& pixels, std::uint32_t width,
                                  std::uint32_t height, const py::object& alpha, double exposure,
                                  const std::string& tone) {
        const relight::Picture picture = picture_of(pixels, width, height, alpha);
        const relight::Development how = development(exposure, tone);
        const Release release;
        relight::save_picture(path, picture, how);
    });
}

py::tuple bounce(Lit& own, const std::optional<std::uint32_t>& bounces, const py::dict& given) {
    const OutputOptions options = options_from<OutputOptions>(given);
    const BounceReport report = change(own, [&](LitScene& lit) {
        const std::vector<glm::vec3> albedo = bounce_albedo(lit.scene(), options);
        return lit.bounce({.albedo = albedo, .limits = {.num_bounces = bounces}});
    });
    return py::make_tuple(report.num_bounces, report.error, report.seconds);
}

/// The receivers' light as it should be: numbers of each, or a picture with these options.
std::function<FitTarget(const LitScene&)> target_from(const py::object& target, std::uint32_t width,
                                                      std::uint32_t height, const py::dict& given) {
    const OutputOptions options = options_from<OutputOptions>(given);
    if (width == 0)
        return [values = vec3s(target.cast<py::buffer>())](const LitScene& lit) {
            return target_of_values(lit.scene(), values,
                                    std::vector(values.size(), glm::vec3(1.0f)));
        };
    return [picture = picture_of(target.cast<py::buffer>(), width, height, py::none()),
            options](const LitScene& lit) {
        return target_of_picture(lit, picture, options);
    };
}

/// Runs `fit(LitScene&, FitTarget, Reins)`, and returns what it gives and the distance that is
/// left.
template<typename Fit>
auto fitted(const LitPointer& own, std::function<FitTarget(const LitScene&)> target,
            const py::object& progress, Fit fit) {
    own->refuse_reentry();
    const Lit::Caller caller(*own);
    return in_background(
        progress, [own, target = std::move(target), fit = std::move(fit)](const Reins& reins) {
            return own->change([&](LitScene& lit) {
                const FitTarget wanted = target(lit);
                auto found = fit(lit, wanted, reins);
                return std::pair(std::move(found), distance_to(wanted, lit));
            });
        });
}

void bind_fits(py::class_<Lit, LitPointer>& type) {
    type.def("fit_environment",
             [](const LitPointer& own, const py::object& target, std::uint32_t width,
                std::uint32_t height, const py::dict& given, std::uint32_t face_resolution,
                double smoothness, double sparsity, std::size_t iterations,
                const py::object& progress) {
                 const EnvironmentFit options{.face_resolution = face_resolution,
                                              .smoothness = smoothness,
                                              .sparsity = sparsity,
                                              .max_iterations = iterations};
                 auto [map, distance] =
                     fitted(own, target_from(target, width, height, given), progress,
                            [=](LitScene& lit, const FitTarget& wanted, const Reins& work) {
                                return fit_environment(lit, wanted, options, work);
                            });
                 return py::make_tuple(owned(std::move(map)), distance);
             })
        .def("fit_lights", [](const LitPointer& own, const py::object& target, std::uint32_t width,
                              std::uint32_t height, const py::dict& given, std::size_t count,
                              const py::object& progress) {
            const auto [lights, distance] =
                fitted(own, target_from(target, width, height, given), progress,
                       [=](LitScene& lit, const FitTarget& wanted, const Reins& work) {
                           return fit_lights(lit, wanted, count, work);
                       });
            return py::make_tuple(arrays_of(lights), distance);
        });
}

} // namespace

void bind_relighters(py::module_& module) {
    module.attr("HIGHLIGHT_RAYS") = DefaultHighlightRays;
    py::class_<Lit, LitPointer> type(module, "Relighter");
    type.def(py::init([](const std::shared_ptr<Scene>& scene, bool clusters_only,
                         std::uint32_t harmonics, std::uint32_t highlight_rays,
                         const py::object& blocked) {
            const LightOptions options{.clusters_only = clusters_only,
                                       .harmonics = harmonics,
                                       .highlight_rays = highlight_rays,
                                       .blockers = blockers_of(blocked)};
            return in_background(
                py::none(), [=](const Reins&) { return std::make_shared<Lit>(scene, options); });
        }))
        .def_property_readonly("is_lit", &Lit::is_lit)
        .def_property_readonly("radiance",
                               [](const LitPointer& own) { return view(own, own->radiance()); })
        .def("set_environment",
             [](Lit& own, const std::shared_ptr<EnvironmentHandle>& environment) {
                 const Environment& made = environment->made;
                 return times_of(change(own, [&](LitScene& lit) {
                     return lit.light(Light({environment, &made.map}, made.file, made.path));
                 }));
             })
        .def("update_environment",
             [](Lit& own, const EnvironmentHandle& environment) {
                 return update_of(
                     change(own, [&](LitScene& lit) { return update(lit, environment.made); }));
             })
        .def("set_frame",
             [](Lit& own, const EnvironmentHandle& environment) {
                 change(own, [&](LitScene& lit) {
                     return lit.light(Light(bin(lit, environment.made.map), environment.made.file));
                 });
             })
        .def("set_lights", &set_lights)
        .def("bounce", &bounce)
        .def("bounced",
             [](Lit& own) {
                 return owned(quickly(own, [](LitScene& lit) { return relumine::bounced(lit); }));
             })
        .def("towards",
             [](Lit& own, const std::array<double, 3>& eye, float tolerance) {
                 own.refuse_reentry();
                 std::vector<glm::vec3> radiance = [&] {
                     const Release release;
                     return own.towards(place_in(own.scene().mesh, {eye[0], eye[1], eye[2]}),
                                        {.tolerance = tolerance});
                 }();
                 return owned(std::move(radiance));
             })
        .def("harmonics",
             [](Lit& own) {
                 std::vector<glm::vec3> light =
                     quickly(own, [](LitScene& lit) { return lit.harmonics(); });
                 const auto height = static_cast<py::ssize_t>(own.scene().receivers.size());
                 const auto width = static_cast<py::ssize_t>(light.size()) / height;
                 return owned(std::move(light), {height, width});
             })
        .def("save_harmonics",
             [](const LitPointer& own, const Path& path) {
                 slowly(own, py::none(), [path](LitScene& lit, const Reins&) {
                     save_harmonics(lit, path);
                     return true;
                 });
             })
        .def("base",
             [](Lit& own) {
                 auto [map, degrees] = quickly(own, [](LitScene& lit) {
                     const LightState& state = lit.environment().state();
                     const bool is_edited = state.base && state.base->map();
                     return std::pair(is_edited ? *state.base->map() : environment_of(lit),
                                      state.rotation_degrees);
                 });
                 return py::make_tuple(owned(std::move(map)), degrees);
             })
        .def("environment", [](Lit& own) {
            cubemap::CubeMap map = quickly(own, [](LitScene& lit) { return environment_of(lit); });
            return owned(std::move(map));
        });
    bind_editing(type);
    bind_moves(type);
    bind_questions(type);
    bind_pictures(module, type);
    bind_fits(type);
    module.def("lat_long_adjoint", &lat_long_adjoint);
    module.def("layer_shapes", &layer_shapes);
    module.def("load_layers", [](const Path& path, const std::optional<double>& frame) {
        const cubemap::LightLayers file = cubemap::load_layers(path);
        return cubemap::json_text(
            {.layers = frame ? cubemap::layers_at(file, *frame) : file.layers});
    });
    module.def("checked_layers", [](const std::string& json) {
        return cubemap::json_text({.layers = checked_layers(json)});
    });
    module.def("save_layers", [](const Path& path, const std::string& json) {
        cubemap::save_layers(path, {.layers = checked_layers(json)});
    });
}

} // namespace relumine::python
