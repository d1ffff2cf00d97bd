#include "app/service/service.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <list>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/command_line/command_line.h"
#include "app/command_table.h"
#include "app/movies/frame_record.h"
#include "app/options/bounce_option.h"
#include "app/options/environment_options.h"
#include "app/options/eye_options.h"
#include "app/options/lit_scene.h"
#include "app/options/output_options.h"
#include "app/report.h"
#include "app/session.h"
#include "cubemap/layers/layer_file.h"
#include "cubemap/layers/layer_list.h"
#include "files/json_reader.h"
#include "files/nearest_name.h"
#include "files/shared_memory.h"
#include "prt/precompute.h"
#include "relight/pictures/array_file.h"
#include "relumine/light/lit_scene.h"

namespace relumine::app {

namespace {

using files::JsonReader;

/// "face-resolution" for "face_resolution": what is easier to write in other languages.
std::string with_dashes(std::string name) {
    std::replace(name.begin(), name.end(), '_', '-');
    return name;
}

/// The name of an option's member: "exposure" of --exposure, "scene" of SCENE.
std::string member_of(const OptionRow& option) {
    return with_dashes(option.key());
}

std::string number_text(double number) {
    return fmt::format("{}", number);
}

/// The text of a value as the command line has it: numbers of a list with commas between them.
std::string value_text(const JsonReader& json, const Report& value, const std::string& name) {
    if (value.type() == Report::Type::String)
        return value.string();
    if (value.type() == Report::Type::Number)
        return number_text(value.number());
    if (value.type() == Report::Type::Array) {
        std::string text;
        for (const Report& each : value.values())
            text += (text.empty() ? "" : ",") + number_text(json.number(each, "a list's value"));
        return text;
    }
    throw UsageError(name, "expected text, a number or a list of numbers");
}

/// A number of a client, as it wrote it.
Report id_of(double number) {
    constexpr double LargestWhole = 0x1p53;
    return number == std::floor(number) && std::abs(number) <= LargestWhole
               ? Report(static_cast<std::int64_t>(number))
               : Report(number);
}

} // namespace

struct Service::Impl {
    explicit Impl(Session& given) : session(given) {}

    /// One request that the service knows: adds its options and its work to a command line.
    struct Request {
        const char* name;
        const char* description;
        void (Impl::*declare)(Command&);
    };
    /// All requests.
    static const std::vector<Request>& requests();
    static const Request& request_named(const std::string& name);

    // The requests. Each sets the report.
    void declare_scene(Command& command);
    void declare_environment(Command& command);
    void declare_edit(Command& command);
    void declare_picture(Command& command);
    void declare_radiance(Command& command);
    void declare_help(Command& command);

    void set_environment(const EnvironmentOptions& options);
    void set_layers(const std::string& path);
    void write_radiance(std::span<const glm::vec3> radiance, const std::string& output,
                        const std::string& shared_memory);
    /// Adds the bounces of the present light and reports them.
    void bounce();

    LitScene& lit() {
        if (!scene)
            throw std::runtime_error("expected the request scene first");
        return *scene;
    }
    const LitScene& lit_by_environment() {
        if (lit().radiance().empty())
            throw std::runtime_error("expected the request environment first");
        return *scene;
    }

    void perform(const JsonReader& json, const Report& root);

    /// The radiance of all receivers; with an eye, with the highlights that it sees.
    std::span<const glm::vec3> radiance(const std::optional<glm::vec3>& eye,
                                        const EyeOptions& options);

    Session& session;
    std::string scene_path;
    std::optional<LitScene> scene;
    /// Highlights of the scene, once an eye was asked for.
    std::optional<LiveEye> live;
    /// Whether they have the present light.
    bool is_live_lit = false;
    BounceOption bounces;

    /// Environments that came before, as they light the scene, the last first.
    struct Binned {
        std::string key;
        BinnedEnvironment environment;
        cubemap::EnvironmentFile file;
    };
    std::list<Binned> binned;

    /// Of the present request.
    Report report;
    std::string arguments;
    const JsonReader* json = nullptr;
    const Report* layers = nullptr;
};

const std::vector<Service::Impl::Request>& Service::Impl::requests() {
    static const std::vector<Request> All = {
        {"scene", "load a scene in place of the present one", &Impl::declare_scene},
        {"environment", "light the scene with an environment; layers stay over it",
         &Impl::declare_environment},
        {"edit", "put layers over the environment in place of the present ones",
         &Impl::declare_edit},
        {"picture", "write the lit scene as `relumine relight` does", &Impl::declare_picture},
        {"radiance", "hand out the radiance of all receivers, albedo 1", &Impl::declare_radiance},
        {"help", "the requests and their members", &Impl::declare_help},
    };
    return All;
}

void Service::Impl::declare_scene(Command& command) {
    auto options = std::make_shared<SceneOptions>();
    auto bounce_option = std::make_shared<BounceOption>();
    options->add_to(command);
    bounce_option->add_to(command);
    command.on_run([this, options, bounce_option] {
        LitScene loaded = lit_scene(*options);
        static_cast<void>(bounce_option->applies_to(loaded.scene(), options->path));
        bounces = *bounce_option;
        binned.clear();
        live.reset();
        scene.emplace(std::move(loaded));
        scene_path = options->path;
        report = {{"receivers", scene->scene().receivers.num_own()},
                  {"clusters", scene->scene().transfer.num_clusters()},
                  {"vertices", scene->scene().mesh.num_vertices()},
                  {"triangles", scene->scene().mesh.num_triangles()}};
    });
}

void Service::Impl::declare_environment(Command& command) {
    auto options = std::make_shared<EnvironmentOptions>();
    options->add_to(command);
    command.on_run([this, options] { set_environment(*options); });
}

void Service::Impl::set_environment(const EnvironmentOptions& options) {
    /// More are forgotten, the oldest first.
    constexpr std::size_t MaxBytes = std::size_t{1} << 29;
    // The same file with the same options is not read again, unless it was saved meanwhile.
    const std::string key = arguments + '\n' + FrameRecord::stamp(options.path);
    LitScene& target = lit();
    auto found =
        std::find_if(binned.begin(), binned.end(), [&](const Binned& b) { return b.key == key; });
    const bool is_kept = found != binned.end();
    if (is_kept) {
        binned.splice(binned.begin(), binned, found);
    } else {
        Environment environment = load_environment(options, session);
        binned.push_front({key, bin(target, std::move(environment.map)), environment.file});
        std::size_t bytes = 0;
        for (auto each = binned.begin(); each != binned.end();) {
            bytes += (each->environment.map->texels.size() + each->file.image->pixels.size()) *
                     sizeof(glm::vec3);
            each =
                bytes > MaxBytes && each != binned.begin() ? binned.erase(each) : std::next(each);
        }
    }
    target.light(Light(binned.front().environment, binned.front().file));
    report = {{"face_resolution", environment_of(target).resolution}, {"was_kept", is_kept}};
    bounce();
}

void Service::Impl::declare_edit(Command& command) {
    auto path = std::make_shared<std::string>();
    command.add(row("--layers", *path,
                    "a list of layers as in a layer file, or the path of a layer file",
                    {.required = true}));
    command.on_run([this, path] { set_layers(*path); });
}

void Service::Impl::set_layers(const std::string& path) {
    static_cast<void>(lit_by_environment());
    std::vector<cubemap::LightLayer> list;
    if (layers != nullptr)
        list = cubemap::read_layers(*json, *layers, ".");
    else
        list = cubemap::load_layers(path).layers;
    const std::size_t count = list.size();
    const UpdateReport update = relumine::set_layers(lit(), std::move(list));
    report = {
        {"layers", count}, {"clusters", update.num_clusters}, {"receivers", update.num_receivers}};
    bounce();
}

void Service::Impl::bounce() {
    is_live_lit = false;
    if (const auto done = bounces.bounce(lit(), {}, scene_path))
        files::update(report, {{"bounces", done->num_bounces}, {"seconds_bounces", done->seconds}});
}

void Service::Impl::declare_picture(Command& command) {
    auto options = std::make_shared<OutputOptions>();
    options->add_to(command);
    command.on_run([this, options] {
        static_cast<void>(lit_by_environment());
        LitScene& source = lit();
        options->check({scene_path});
        options->check_fits(source.scene());
        Stopwatch watch;
        source.dim(options->for_scene(source.scene()).emission);
        is_live_lit = false;
        const double seconds_dim = watch.total();
        Painter painter(source, options->picture);
        painter.save(options->path, source.lighting());
        report = {{"output", options->path},
                  {"exposure", painter.exposure_ev(options->path)},
                  {"seconds_dim", seconds_dim}};
    });
}

void Service::Impl::declare_radiance(Command& command) {
    struct Options {
        std::string output;
        std::string shared_memory;
        std::optional<glm::vec3> eye;
        EyeOptions eye_options;
    };
    auto options = std::make_shared<Options>();
    command.add(
        row("-o,--output", options->output, "an .npy file [receivers x 3]", {.file = true}));
    command.add(row("--shared-memory", options->shared_memory,
                    "POSIX shared memory that the client has made: float32 [receivers x 3]"));
    command.add(row<PointText>("--eye", options->eye,
                               "X,Y,Z: the radiance towards this eye, of a scene of glossy "
                               "vertices without --view",
                               {.example = "1,2,3"}));
    command.add(glossy_tolerance_row(options->eye_options));
    command.on_run([this, options] {
        if (options->output.empty() == options->shared_memory.empty())
            throw UsageError("output", "expected either output or shared-memory");
        write_radiance(radiance(options->eye, options->eye_options), options->output,
                       options->shared_memory);
    });
}

std::span<const glm::vec3> Service::Impl::radiance(const std::optional<glm::vec3>& eye,
                                                   const EyeOptions& options) {
    const LitScene& source = lit_by_environment();
    if (!eye)
        return source.radiance();
    require_live_highlights(source.scene(), scene_path);
    warn_of_eye_inside(source, eye, session);
    if (!live) {
        live.emplace(source);
        warn_of_smooth_surfaces(live->num_too_smooth(), session);
    } else if (!is_live_lit) {
        live->take_light();
    }
    is_live_lit = true;
    return live->look(*eye, options);
}

void Service::Impl::write_radiance(std::span<const glm::vec3> radiance, const std::string& output,
                                   const std::string& shared_memory) {
    if (output.empty()) {
        files::write_shared_memory(shared_memory, std::as_bytes(radiance));
    } else {
        if (extension_of(output) != ".npy")
            throw UsageError("output",
                             fmt::format("expected a name that ends in .npy, got '{}'", output));
        check_output(output, {scene_path});
        relight::save_npy(output, radiance);
    }
    report = {{"receivers", radiance.size()}, {"bytes", radiance.size_bytes()}};
}

void Service::Impl::declare_help(Command& command) {
    command.on_run([this] {
        std::vector<Report> all;
        for (const Request& request : requests()) {
            CommandLine line("relumine", "");
            Command below = line.root().add_command(request.name, request.description);
            (this->*request.declare)(below);
            Report members;
            const CommandTable table = line.table();
            for (const OptionRow& option : table.commands.front().options)
                if (member_of(option) != "help")
                    members.set(member_of(option), option.help);
            all.push_back(
                {{"do", request.name}, {"description", request.description}, {"members", members}});
        }
        report = {{"requests", all}};
    });
}

const Service::Impl::Request& Service::Impl::request_named(const std::string& name) {
    std::vector<std::string_view> names;
    for (const Request& each : requests()) {
        if (each.name == name)
            return each;
        names.emplace_back(each.name);
    }
    throw UsageError("do", fmt::format("expected a request, got '{}'{}", name,
                                       files::did_you_mean(name, names)));
}

/// Makes a command line of the request's members and runs it: so they are checked as there.
void Service::Impl::perform(const JsonReader& reader, const Report& root) {
    const Report::Object& members = reader.object(root, "a request");
    const std::string& name = reader.string(reader.required(root, "do"), "\"do\"");
    const Request& request = request_named(name);
    CommandLine line("relumine", "");
    Command command = line.root().add_command(request.name, request.description);
    (this->*request.declare)(command);

    const OptionTable options = line.table().commands.front().options;
    std::vector<std::string> known = {"do", "id"};
    for (const OptionRow& option : options)
        if (member_of(option) != "help")
            known.push_back(member_of(option));
    std::vector<std::string> words = {request.name};
    std::vector<std::string> values;
    json = &reader;
    layers = nullptr;
    for (const auto& [given, value] : members) {
        const std::string member = with_dashes(given);
        if (std::find(known.begin(), known.end(), member) == known.end())
            throw UsageError(given, fmt::format("no member of the request {}{}", name,
                                                files::did_you_mean(member, known)));
        if (member == "do" || member == "id")
            continue;
        const OptionRow& option =
            *std::find_if(options.begin(), options.end(),
                          [&](const OptionRow& each) { return member_of(each) == member; });
        if (member == "layers" && value.type() == Report::Type::Array) {
            layers = &value;
            words.emplace_back("--layers=a list");
            continue;
        }
        const bool is_list = option.repeats && value.type() == Report::Type::Array &&
                             !value.values().empty() &&
                             value.values().front().type() == Report::Type::String;
        if (is_list) {
            for (const Report& each : value.values())
                words.push_back(fmt::format("--{}={}", member, value_text(reader, each, member)));
        } else if (option.is_flag) {
            if (reader.boolean(value, fmt::format("\"{}\"", member)))
                words.push_back("--" + member);
        } else if (const std::string text = value_text(reader, value, member);
                   option.is_argument()) {
            values.push_back(text);
        } else {
            words.push_back(fmt::format("--{}={}", member, text));
        }
    }
    if (!values.empty()) {
        words.emplace_back("--");
        words.insert(words.end(), values.begin(), values.end());
    }
    arguments.clear();
    for (const std::string& word : words)
        arguments += word + '\n';
    static_cast<void>(line.run(std::move(words)));
}

Service::Service(Session& session) : impl_(std::make_unique<Impl>(session)) {}
Service::~Service() = default;

std::string Service::answer(std::string_view request) {
    const JsonReader reader("request");
    Report id;
    bool has_id = false;
    const auto answered = [&](bool is_ok, const Report& fields) {
        Report answer = {{"ok", is_ok}};
        files::update(answer, fields);
        files::update(answer, impl_->session.take_notes());
        if (has_id)
            answer.set("id", id);
        return answer.text();
    };
    const Stopwatch watch;
    const auto failed = [&](const std::string& message) {
        return answered(false, {{"error", one_line(message)}, {"seconds", watch.total()}});
    };
    impl_->report = Report();
    try {
        const Report root = reader.parse(std::as_bytes(std::span(request)));
        if (const Report* given = root.find("id")) {
            id = given->type() == Report::Type::Number ? id_of(given->number())
                                                       : Report(reader.string(*given, "\"id\""));
            has_id = true;
        }
        impl_->perform(reader, root);
        impl_->report.set("seconds", watch.total());
        return answered(true, impl_->report);
    } catch (const prt::Cancelled&) {
        throw;
    } catch (const std::bad_alloc&) {
        return failed("out of memory");
    } catch (const std::exception& error) {
        return failed(error.what());
    }
}

std::string Service::refusal(const std::string& message) {
    return Report{{"ok", false}, {"error", one_line(message)}, {"seconds", 0.0}}.text();
}

} // namespace relumine::app
