#include <algorithm>
#include <string>

#include <imgui.h>

#include <glm/vec4.hpp>

#include "viewer/panels.h"

namespace relumine::viewer {

namespace {

glm::vec2 pointer() {
    return {ImGui::GetIO().MousePos.x, ImGui::GetIO().MousePos.y};
}

/// A slider and a colour of a lamp; without a name, of all.
void dimmer_row(ViewState& state, const std::string& name) {
    const glm::vec3 now = dimmer(state.desk, name);
    float strength = std::max({now.r, now.g, now.b});
    glm::vec3 color = strength > 0.0f ? now / strength : glm::vec3(1.0f);
    constexpr float Most = 8.0f;
    ImGui::PushID(name.c_str());
    ImGui::SetNextItemWidth(150.0f);
    bool is_changed =
        ImGui::SliderFloat("##dimmer", &strength, 0.0f, Most, "%.2f", ImGuiSliderFlags_Logarithmic);
    ImGui::SameLine();
    is_changed |= ImGui::ColorEdit3("##colour", &color.x, ImGuiColorEditFlags_NoInputs);
    ImGui::SameLine();
    ImGui::TextUnformatted(name.empty() ? "all lamps" : name.c_str());
    ImGui::PopID();
    if (is_changed)
        set_dimmer(state.desk, name, strength * color);
}

/// The scene's own lamps, where it has any.
void dimmers(ViewState& state) {
    const prt::Lamps& lamps = state.desk.lit().scene().lamps;
    if (lamps.empty())
        return;
    next_button("Lamps");
    if (ImGui::Button("Lamps"))
        ImGui::OpenPopup("lamps");
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Dims and colours the lamps of the scene, as --emission does");
    if (!ImGui::BeginPopup("lamps"))
        return;
    dimmer_row(state, "");
    for (const std::string& name : lamps.names())
        dimmer_row(state, name);
    ImGui::EndPopup();
}

/// The roughness of highlights that follow the eye.
void polish(ViewState& state) {
    if (!state.live_eye)
        return;
    constexpr float Width = 110.0f;
    next_item(Width);
    ImGui::SetNextItemWidth(Width);
    ImGui::SliderFloat("##roughness", &state.roughness, relight::NarrowestLiveRoughness, 1.0f,
                       "rough %.2f", ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("The roughness of all glossy surfaces, as --material roughness=R does");
}

void tools(ViewState& state, const PixelRectangle& place, const PixelRectangle& picture) {
    begin_panel("scene tools", place);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Exposure");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(150.0f);
    ImGui::SliderFloat("##scene exposure", &state.scene_look.exposure_ev, -10.0f, 10.0f,
                       "%+.2f EV");
    next_checkbox("Wireframe");
    ImGui::Checkbox("Wireframe", &state.scene_look.wireframe);
    next_checkbox("Background");
    ImGui::Checkbox("Background", &state.scene_look.background);
    next_button("Frame all");
    if (ImGui::Button("Frame all"))
        state.camera = camera_on_all(state.desk.lit().scene(), picture, state.picture);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("F: the camera that relumine relight takes");
    next_button("Save picture");
    if (ImGui::Button("Save picture"))
        save_picture(state, picture, new_picture(state));
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("P: a new picture as relumine relight draws it, .png or .exr, of the "
                          "name in the field of files or picture-1.png and on");
    int click = static_cast<int>(state.click);
    constexpr float ChoiceWidth = 130.0f;
    next_item(ChoiceWidth);
    ImGui::SetNextItemWidth(ChoiceWidth);
    if (ImGui::Combo("##click", &click,
                     "click: asks\0click: lights\0click: mirrors\0drag: moves\0"))
        state.click = static_cast<Click>(click);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("A click on the model: shows what lights the point, moves the chosen "
                          "layer so that it lights it (Ctrl), or so that the point mirrors it "
                          "(Ctrl-Shift). A drag moves the thing below the pointer over a level "
                          "plane (Alt), or before the eye (Alt-Shift); the wheel turns it");
    polish(state);
    dimmers(state);
    ImGui::End();
}

/// What a click does now: the keys go before the choice.
Click click_of(const ViewState& state) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.KeyAlt)
        return Click::Move;
    return !io.KeyCtrl ? state.click : io.KeyShift ? Click::Mirror : Click::Face;
}

/// Lets the chosen layer follow the pointer over the mesh, from the press on. Returns false where
/// the pointer does something else.
bool aim_by_pointer(ViewState& state, const PixelRectangle& place) {
    if (ImGui::IsItemClicked(ImGuiMouseButton_Left) && click_of(state) != Click::Ask &&
        click_of(state) != Click::Move) {
        state.is_aiming = state.desk.selected().has_value();
        state.message = state.is_aiming ? "" : "choose a layer first: a click moves its light";
        state.message_is_error = !state.is_aiming;
    }
    if (!state.is_aiming)
        return false;
    if (ImGui::IsMouseDown(ImGuiMouseButton_Left) && state.desk.selected()) {
        aim_light(state, *state.desk.selected(), place, pointer(),
                  click_of(state) == Click::Mirror ? Aim::Mirrored : Aim::Facing);
    } else {
        state.is_aiming = false;
        state.desk.finish();
        state.heat_is_stale = true;
    }
    return true;
}

/// Lets a thing of the scene follow the pointer, from the press on. Returns false where the pointer
/// does something else.
bool drag_by_pointer(ViewState& state, const PixelRectangle& place) {
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsItemClicked(ImGuiMouseButton_Left) && click_of(state) == Click::Move)
        take_thing(state, place, pointer());
    if (!state.thing.is_dragging())
        return false;
    constexpr double DegreesPerStep = 5.0;
    const bool is_still = io.MouseDelta.x == 0.0f && io.MouseDelta.y == 0.0f;
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left))
        drop_thing(state);
    else if (!is_still || io.MouseWheel != 0.0f)
        drag_thing(state, place, pointer(), io.KeyShift,
                   DegreesPerStep * static_cast<double>(io.MouseWheel));
    return true;
}

void point_and_drag_in_scene(ViewState& state, const PixelRectangle& place) {
    const ImGuiIO& io = ImGui::GetIO();
    constexpr float ClickReach = 4.0f; // pixels
    if (drag_by_pointer(state, place))
        return;
    if (ImGui::IsItemHovered() && io.MouseWheel != 0.0f)
        state.camera.zoom(io.MouseWheel);
    if (aim_by_pointer(state, place))
        return;
    const glm::vec2 moved(io.MouseDelta.x, io.MouseDelta.y);
    if (ImGui::IsItemActive()) {
        const bool flies = ImGui::IsMouseDown(ImGuiMouseButton_Right);
        const bool pans = ImGui::IsMouseDown(ImGuiMouseButton_Middle) || io.KeyShift;
        const bool is_click = ImGui::IsMouseDown(ImGuiMouseButton_Left) &&
                              !ImGui::IsMouseDragging(ImGuiMouseButton_Left, ClickReach);
        if (flies) {
            // A way as long as to the target takes one and a half seconds.
            state.camera.look(moved);
            state.camera.fly(state.steering * (io.DeltaTime * state.camera.distance / 1.5f));
        } else if (pans)
            state.camera.pan(moved, place);
        else if (!is_click)
            state.camera.orbit(moved);
    }
    if (ImGui::IsItemHovered() && ImGui::IsMouseReleased(ImGuiMouseButton_Left) &&
        io.MouseDragMaxDistanceSqr[ImGuiMouseButton_Left] < ClickReach * ClickReach)
        click_mesh(state, place, pointer());
}

/// Draws a ring at the chosen receiver.
void draw_receiver(const ViewState& state, const PixelRectangle& place) {
    if (!state.receiver)
        return;
    const glm::vec3 position = state.mesh.positions[*state.receiver];
    const glm::vec4 clip = clip_from_world(state.camera, place, 1.0f) * glm::vec4(position, 1.0f);
    if (clip.w <= 0.0f)
        return;
    const ImVec2 at(static_cast<float>(place.x) +
                        (0.5f + 0.5f * clip.x / clip.w) * static_cast<float>(place.width),
                    static_cast<float>(place.y) +
                        (0.5f - 0.5f * clip.y / clip.w) * static_cast<float>(place.height));
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddCircle(at, 7.0f, IM_COL32(0, 0, 0, 200), 0, 4.0f);
    list.AddCircle(at, 7.0f, IM_COL32(255, 190, 60, 255), 0, 2.0f);
}

} // namespace

void next_item(float width) {
    const float end = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    if (ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width <= end)
        ImGui::SameLine();
}

void next_button(const char* label) {
    next_item(ImGui::CalcTextSize(label).x + 2.0f * ImGui::GetStyle().FramePadding.x);
}

void next_checkbox(const char* label) {
    next_item(ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x +
              ImGui::CalcTextSize(label).x);
}

void begin_panel(const char* name, const PixelRectangle& place, bool over_picture) {
    ImGui::SetNextWindowPos({static_cast<float>(place.x), static_cast<float>(place.y)});
    ImGui::SetNextWindowSize({static_cast<float>(place.width), static_cast<float>(place.height)});
    ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                             ImGuiWindowFlags_NoSavedSettings |
                             ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav;
    if (over_picture)
        flags |= ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoScrollWithMouse;
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, over_picture ? ImVec2(0, 0) : ImVec2(10, 7));
    ImGui::Begin(name, nullptr, flags);
    ImGui::PopStyleVar();
}

void scene_panel(ViewState& state, const PanelLayout& layout) {
    tools(state, layout.scene_tools, layout.scene);
    begin_panel("scene", layout.scene, true);
    ImGui::InvisibleButton("scene picture", ImGui::GetContentRegionAvail(),
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                               ImGuiButtonFlags_MouseButtonMiddle);
    point_and_drag_in_scene(state, layout.scene);
    draw_receiver(state, layout.scene);
    ImGui::End();
}

} // namespace relumine::viewer
