#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "files/one_of_each.h"
#include "relumine/in/environment_files.h"
#include "relumine/light/layers.h"
#include "viewer/panels.h"

namespace relumine::viewer {

namespace {

/// Returns a new layer where the environment's view looks, as bright as the scene's exposure asks
/// for.
cubemap::LightLayer new_layer(const ViewState& state, std::string name, cubemap::Region region,
                              cubemap::Effect effect) {
    const glm::dvec3 direction =
        turned(direction_at(state.lat_long.center), -state.desk.state().rotation_degrees);
    region = centred(std::move(region), direction);
    if (auto* emit = std::get_if<cubemap::Emit>(&effect))
        emit->radiance *= 4.0f * std::exp2(-state.scene_look.exposure_ev);
    return {.name = std::move(name), .region = std::move(region), .effect = std::move(effect)};
}

void hint(std::string_view text) {
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("%.*s", static_cast<int>(text.size()), text.data());
}

std::string capitalised(std::string_view text) {
    std::string result(text);
    result[0] = static_cast<char>(result[0] - 'a' + 'A');
    return result;
}

/// Whether a shape can be placed; others are drawn.
bool has_direction(cubemap::Region shape) {
    const std::vector<cubemap::LayerField> all = fields(shape);
    return std::any_of(all.begin(), all.end(),
                       [](const auto& field) { return field.direction != nullptr; });
}

void add_buttons(ViewState& state) {
    std::function<void()> later;
    for (const cubemap::Region& shape : files::one_of_each<cubemap::Region>())
        if (has_direction(shape)) {
            const std::string name = capitalised(words(shape).label);
            if (ImGui::Button(("+ " + name).c_str()))
                add(state.desk, new_layer(state, name, as_added(shape), cubemap::Emit{}));
            hint(words(shape).hint);
            next_button("+ Soft box");
        }
    if (ImGui::Button("+ Gain"))
        add(state.desk,
            new_layer(state, "Gain", cubemap::Disc{.radius_degrees = 20.0, .softness = 0.5},
                      cubemap::Gain{.factor = 0.25f}));
    hint("a disc that dims or brightens what is there");
    next_button("+ Lasso");
    if (ImGui::Button("+ Lasso"))
        state.tool = Tool::Lasso;
    hint(cubemap::Lasso::Words.hint);
    next_button("+ Stroke");
    if (ImGui::Button("+ Stroke"))
        state.tool = Tool::Paint;
    hint(cubemap::Stroke::Words.hint);
    next_button("+ Preset");
    if (ImGui::Button("+ Preset"))
        ImGui::OpenPopup("presets");
    hint("a light as studios have them");
    if (ImGui::BeginPopup("presets")) {
        for (const cubemap::LayerPreset& preset : cubemap::layer_presets()) {
            const std::string& name = preset.layer.name;
            if (ImGui::Selectable(name.c_str()))
                add(state.desk, new_layer(state, name, preset.layer.region, preset.layer.effect));
            hint(preset.hint);
        }
        ImGui::EndPopup();
    }
    next_button("+ Image");
    if (ImGui::Button("+ Image"))
        add_image(state, state.path);
    hint("the picture named below, .exr or .hdr, as a layer; or drop one on the window");
    next_button("Undo Redo ");
    ImGui::BeginDisabled(!state.desk.history().can_undo(state.desk.state()));
    if (ImGui::Button("Undo"))
        later = [&state] {
            state.desk.undo();
        };
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!state.desk.history().can_redo());
    if (ImGui::Button("Redo"))
        later = [&state] {
            state.desk.redo();
        };
    ImGui::EndDisabled();
    if (later) {
        later();
        state.heat_is_stale = true;
    }
}

/// Returns "disc", "gain disc", ... or "image".
std::string kind(const cubemap::LightLayer& layer) {
    if (std::holds_alternative<cubemap::ImagePatch>(layer.effect))
        return "image";
    std::string label(words(layer.region).label);
    if (std::holds_alternative<cubemap::Gain>(layer.effect))
        return "gain " + label.substr(label.rfind(' ') + 1);
    return label;
}

/// Edits a layer while an item is held. Letting go makes a step of undo.
class Form {
public:
    Form(ViewState& state, std::size_t index)
        : state_(state), index_(index), layer_(state.desk.layers()[index]) {}
    ~Form() = default;
    Form(const Form&) = delete;
    Form& operator=(const Form&) = delete;

    [[nodiscard]] cubemap::LightLayer& layer() { return layer_; }

    /// Shows what has_row() says: a slider or a colour. Label and unit follow from the name.
    void row(const cubemap::LayerField& field) {
        const std::string label = capitalised(field.name.substr(0, field.name.find('_')));
        if (field.colour != nullptr)
            color(label.c_str(), *field.colour);
        else
            number(label.c_str(), field);
    }
    void note(bool changed) {
        changed_ = changed_ || changed;
        finished_ = finished_ || ImGui::IsItemDeactivatedAfterEdit();
    }
    void apply() {
        if (changed_)
            change(state_.desk, index_, layer_);
        if (finished_) {
            state_.desk.finish();
            state_.heat_is_stale = true;
        }
    }

private:
    void number(const char* label, const cubemap::LayerField& field) {
        const auto [from, to] = field.slider.value_or(field.range);
        const char* format = field.name.ends_with("_degrees") ? "%.1f\xc2\xb0"
                             : field.name.ends_with("_ev")    ? "%+.2f EV"
                             : field.single != nullptr        ? "%.3f"
                                                              : "%.2f";
        auto shown = static_cast<float>(values(field)[0]);
        if (field.name == "kelvin")
            format = shown > 0.0f ? "%.0f K" : "the colour's own";
        const bool changed = ImGui::SliderFloat(
            label, &shown, static_cast<float>(from), static_cast<float>(to), format,
            field.logarithmic_slider ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None);
        double value = std::clamp(static_cast<double>(shown), from, to);
        if (value < field.least_but_zero)
            value = value < 0.5 * field.least_but_zero ? 0.0 : field.least_but_zero;
        if (changed)
            set_values(field, std::array{value});
        note(changed);
    }
    void color(const char* label, glm::vec3& value) {
        const bool changed =
            ImGui::ColorEdit3(label, &value.x, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR);
        value = glm::max(value, glm::vec3(0.0f));
        note(changed);
    }

    ViewState& state_;
    std::size_t index_;
    cubemap::LightLayer layer_;
    bool changed_ = false;
    bool finished_ = false;
};

/// Draws one row of the list. Returns the change to the whole list, to be made once the list is
/// drawn.
std::function<void()> layer_row(ViewState& state, std::size_t index) {
    std::function<void()> later;
    const cubemap::LightLayer layer = state.desk.layers()[index];
    ImGui::PushID(static_cast<int>(index));
    bool on = layer.on;
    if (ImGui::Checkbox("##on", &on)) {
        cubemap::LightLayer changed = layer;
        changed.on = on;
        later = [&state, index, changed] {
            change(state.desk, index, changed);
            state.desk.finish();
        };
    }
    ImGui::SameLine(0.0f, 4.0f);
    if (layer.solo)
        ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_CheckMark));
    if (ImGui::Button("S"))
        later = [&state, index] {
            set_solo(state.desk, index, !state.desk.layers()[index].solo);
        };
    if (layer.solo)
        ImGui::PopStyleColor();
    hint("solo: this light alone, without the environment");
    ImGui::SameLine();
    const float right = ImGui::GetContentRegionMax().x;
    const float width = ImGui::GetContentRegionAvail().x - 220.0f;
    if (ImGui::Selectable(layer.name.c_str(), state.desk.selected() == index, 0, {width, 0.0f}))
        state.desk.select(index);
    ImGui::SameLine(right - 212.0f);
    ImGui::TextDisabled("%s", kind(layer).c_str());
    ImGui::SameLine(right - 130.0f);
    ImGui::TextDisabled("%+.1f", layer.gain_ev);
    hint("gain in stops");
    ImGui::SameLine(right - 80.0f);
    const std::size_t top = state.desk.layers().size() - 1;
    if (ImGui::ArrowButton("##up", ImGuiDir_Up) && index < top)
        later = [&state, index] {
            reorder(state.desk, index, index + 1);
        };
    ImGui::SameLine(0.0f, 2.0f);
    if (ImGui::ArrowButton("##down", ImGuiDir_Down) && index > 0)
        later = [&state, index] {
            reorder(state.desk, index, index - 1);
        };
    ImGui::SameLine(0.0f, 2.0f);
    if (ImGui::Button("x"))
        later = [&state, index] {
            remove(state.desk, index);
        };
    ImGui::PopID();
    return later;
}

/// Directions and points are dragged in the environment.
bool has_row(const cubemap::LayerField& field) {
    return field.number != nullptr || field.single != nullptr || field.colour != nullptr;
}

/// Offers the effects: any region may give light or change the light below; a picture is laid over
/// that light or added to it.
void effect_choice(Form& form) {
    cubemap::Effect& effect = form.layer().effect;
    int chosen = 0;
    bool changed = false;
    if (auto* patch = std::get_if<cubemap::ImagePatch>(&effect)) {
        chosen = patch->blend == cubemap::ImagePatch::Blend::Replace ? 0 : 1;
        changed = ImGui::Combo("Picture", &chosen, "replaces what is there\0is added\0");
        if (changed)
            patch->blend =
                chosen == 0 ? cubemap::ImagePatch::Blend::Replace : cubemap::ImagePatch::Blend::Add;
    } else {
        chosen = std::holds_alternative<cubemap::Emit>(effect) ? 0 : 1;
        changed = ImGui::Combo("Effect", &chosen, "gives light\0dims or brightens\0");
        if (changed && chosen == 0)
            effect = cubemap::Emit{};
        else if (changed)
            effect = cubemap::Gain{};
    }
    form.note(changed);
}

void layer_fields(ViewState& state, std::size_t index) {
    Form form(state, index);
    ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.62f);
    std::string name = form.layer().name;
    const bool renamed = ImGui::InputText("Name", &name);
    const std::optional<std::size_t> other = find(state.desk, name);
    if (renamed && !name.empty() && (!other || *other == index))
        form.layer().name = name;
    form.note(renamed);
    for (const cubemap::LayerField& field : own_fields(form.layer()))
        if (has_row(field))
            form.row(field);
    effect_choice(form);
    for (const auto& part : {fields(form.layer().effect), fields(form.layer().region)})
        for (const cubemap::LayerField& field : part)
            if (has_row(field))
                form.row(field);
    form.note(ImGui::Checkbox("In the picture", &form.layer().camera));
    hint("off: it gives light and is not seen behind the scene");
    ImGui::PopItemWidth();
    form.apply();
}

/// Returns the number of rows that layer_fields() draws.
int num_field_rows(const ViewState& state) {
    if (!state.desk.selected())
        return 0;
    cubemap::LightLayer layer = state.desk.layers()[*state.desk.selected()];
    const std::vector<cubemap::LayerField> all = fields(layer);
    return 3 + static_cast<int>(std::count_if(all.begin(), all.end(), has_row));
}

void files(ViewState& state) {
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - 245.0f);
    if (std::exchange(state.wants_path, false))
        ImGui::SetKeyboardFocusHere();
    const bool entered =
        ImGui::InputTextWithHint("##path", "file: .exr .hdr .json, or drop one on the window",
                                 &state.path, ImGuiInputTextFlags_EnterReturnsTrue);
    ImGui::SameLine();
    if (ImGui::Button("Open") || entered)
        open(state, state.path);
    ImGui::SameLine();
    if (ImGui::Button("Save layers"))
        save_layers(state, state.path);
    ImGui::SameLine();
    if (ImGui::Button("Save env"))
        save_environment(state, state.path);
}

} // namespace

void layer_panel(ViewState& state, const PanelLayout& layout) {
    begin_panel("layers", layout.layers);
    const auto work = [&] {
        add_buttons(state);
        ImGui::Spacing();
        std::function<void()> later;
        const float row = ImGui::GetFrameHeightWithSpacing();
        const float fields_height = row * static_cast<float>(num_field_rows(state)) + row + 14.0f;
        const float list_height =
            std::max(ImGui::GetContentRegionAvail().y - fields_height, 2.5f * row);
        ImGui::BeginChild("list", {0.0f, list_height}, true);
        for (std::size_t i = state.desk.layers().size(); i-- > 0;) // the top of the stack first
            if (std::function<void()> wanted = layer_row(state, i))
                later = std::move(wanted);
        if (state.desk.layers().empty())
            ImGui::TextDisabled("No layers yet: the environment as it is.");
        ImGui::EndChild();
        if (later) {
            later();
            state.heat_is_stale = true;
        }
        if (state.desk.selected())
            layer_fields(state, *state.desk.selected());
    };
    try {
        work();
    } catch (const std::exception& error) { // a number that no layer can have
        state.message = error.what();
        state.message_is_error = true;
    }
    ImGui::SetCursorPosY(static_cast<float>(layout.layers.height) - ImGui::GetFrameHeight() - 8.0f);
    files(state);
    ImGui::End();
}

void status_panel(const ViewState& state, const PanelLayout& layout) {
    begin_panel("status", layout.status);
    const LitScene& lit = state.desk.lit();
    const EditCost& cost = state.desk.last_cost();
    ImGui::Text("frame %.1f ms", 1e3 * state.frame_seconds);
    ImGui::SameLine(0.0f, 22.0f);
    const std::string last = fmt::format(
        "last edit {:.2f} ms: {} of {} clusters, {} of {} receivers", 1e3 * cost.seconds,
        cost.report.num_clusters, lit.relighter().transfer().num_clusters(),
        cost.report.num_receivers, lit.radiance().size());
    ImGui::TextUnformatted(last.c_str());
    ImGui::SameLine(0.0f, 22.0f);
    const std::string camera = camera_options(state.camera, lit.scene().mesh.offset);
    if (ImGui::SmallButton(camera.c_str()))
        ImGui::SetClipboardText(camera.c_str());
    hint("a click copies these options of relumine relight");
    ImGui::SameLine(0.0f, 22.0f);
    if (state.message_is_error)
        ImGui::TextColored({1.0f, 0.45f, 0.4f, 1.0f}, "%s", state.message.c_str());
    else
        ImGui::TextDisabled("%s", state.message.c_str());
    ImGui::End();
}

} // namespace relumine::viewer
