#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <variant>
#include <vector>

#include <imgui.h>

#include "viewer/panels.h"

namespace relumine::viewer {

namespace {

/// Pixels within which the pointer holds a rim.
constexpr double RimReach = 7.0;

ImVec2 im(const glm::dvec2& pixel) {
    return {static_cast<float>(pixel.x), static_cast<float>(pixel.y)};
}

void picture_tools(ViewState& state) {
    // The sliders take the room that the words leave. In a narrow window their own text says
    // enough.
    const float width = ImGui::GetContentRegionAvail().x;
    const bool is_narrow = width < 512.0f;
    const float slider_width =
        std::clamp(0.5f * (width - (is_narrow ? 260.0f : 400.0f)), 40.0f, 140.0f);
    const auto label = [is_narrow](const char* text) {
        if (is_narrow)
            return;
        ImGui::AlignTextToFramePadding();
        ImGui::TextUnformatted(text);
        ImGui::SameLine();
    };
    label("Exposure");
    ImGui::SetNextItemWidth(slider_width);
    ImGui::SliderFloat("##env exposure", &state.environment_look.exposure_ev, -15.0f, 15.0f,
                       "%+.2f EV");
    ImGui::SameLine();
    label("Rotate");
    ImGui::SetNextItemWidth(slider_width);
    auto degrees = static_cast<float>(state.desk.state().rotation_degrees);
    if (ImGui::SliderFloat("##rotate", &degrees, -180.0f, 180.0f, "%.0f\xc2\xb0"))
        set_rotation(state.desk, degrees);
    if (ImGui::IsItemDeactivatedAfterEdit()) {
        state.desk.finish();
        state.heat_is_stale = true;
    }
    ImGui::SameLine();
    ImGui::Checkbox("Clusters", &state.environment_look.quadtree);
    ImGui::SameLine();
    ImGui::Checkbox("Who lights this", &state.environment_look.heat);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Click the mesh: what lights that point is laid over the environment");
}

void brush_tools(ViewState& state) {
    auto& stroke = std::get<cubemap::Stroke>(state.brush.region);
    auto& emit = std::get<cubemap::Emit>(state.brush.effect);
    auto radius = static_cast<float>(stroke.radius_degrees);
    auto softness = static_cast<float>(stroke.softness);
    ImGui::SetNextItemWidth(120.0f);
    if (ImGui::SliderFloat("##brush radius", &radius, 0.2f, 40.0f, "brush %.1f\xc2\xb0",
                           ImGuiSliderFlags_Logarithmic))
        stroke.radius_degrees = std::clamp(radius, 0.05f, 90.0f);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(100.0f);
    if (ImGui::SliderFloat("##brush softness", &softness, 0.0f, 1.0f, "soft %.2f"))
        stroke.softness = std::clamp(softness, 0.0f, 1.0f);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(190.0f);
    if (ImGui::ColorEdit3("##brush radiance", &emit.radiance.x,
                          ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR))
        emit.radiance = glm::max(emit.radiance, glm::vec3(0.0f));
}

void lasso_tools(ViewState& state) {
    auto& lasso = std::get<cubemap::Lasso>(state.lasso.region);
    auto& gain = std::get<cubemap::Gain>(state.lasso.effect);
    auto softness = static_cast<float>(lasso.softness_degrees);
    ImGui::SetNextItemWidth(110.0f);
    if (ImGui::SliderFloat("##lasso softness", &softness, 0.0f, 30.0f, "soft %.1f\xc2\xb0"))
        lasso.softness_degrees = std::clamp(softness, 0.0f, 90.0f);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(110.0f);
    if (ImGui::SliderFloat("##lasso factor", &gain.factor, 0.0f, 16.0f, "times %.2f",
                           ImGuiSliderFlags_Logarithmic))
        gain.factor = std::max(gain.factor, 0.0f);
    ImGui::SameLine();
    ImGui::TextDisabled("drag around it");
}

void edit_tools(ViewState& state) {
    if (ImGui::RadioButton("Move", state.tool == Tool::Move))
        state.tool = Tool::Move;
    ImGui::SameLine();
    if (ImGui::RadioButton("Paint", state.tool == Tool::Paint))
        state.tool = Tool::Paint;
    ImGui::SameLine();
    if (ImGui::RadioButton("Lasso", state.tool == Tool::Lasso))
        state.tool = Tool::Lasso;
    ImGui::SameLine(0.0f, 20.0f);
    if (state.tool == Tool::Move)
        ImGui::TextDisabled("drag a layer or its rim; drag elsewhere: pan; wheel: zoom");
    else if (state.tool == Tool::Paint)
        brush_tools(state);
    else
        lasso_tools(state);
}
/// Draws a line over the picture, once for each visible copy of the picture.
void draw_line(const ViewState& state, const PixelRectangle& place,
               const std::vector<glm::dvec3>& line, ImU32 color, float thickness) {
    const std::vector<glm::dvec2> uv = unrolled(line);
    const auto [low, high] = std::minmax_element(
        uv.begin(), uv.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
    const double left = state.lat_long.uv_at(place, {place.x, place.y}).x;
    const double right = state.lat_long.uv_at(place, {place.x + place.width, place.y}).x;
    std::vector<ImVec2> points;
    for (double turn = std::ceil(left - high->x); low->x + turn <= right; turn += 1.0) {
        points.clear();
        for (const glm::dvec2& at : uv) {
            const ImVec2 pixel = im(state.lat_long.pixel_at(place, at + glm::dvec2(turn, 0.0)));
            // Points that nearly coincide would give the line spikes.
            if (points.empty() ||
                std::hypot(pixel.x - points.back().x, pixel.y - points.back().y) > 1.0f)
                points.push_back(pixel);
        }
        ImGui::GetWindowDrawList()->AddPolyline(points.data(), static_cast<int>(points.size()),
                                                color, 0, thickness);
    }
}

void draw_layers(const ViewState& state, const PixelRectangle& place) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const bool is_solo = cubemap::has_solo(state.desk.layers());
    for (std::size_t i = 0; i < state.desk.layers().size(); ++i) {
        const cubemap::LightLayer& layer = state.desk.layers()[i];
        const bool chosen = state.desk.selected() == i;
        const cubemap::Region region = turned(layer.region, state.desk.state().rotation_degrees);
        const std::vector<glm::dvec3> rim = outline(region);
        const ImU32 color = chosen                            ? IM_COL32(255, 190, 60, 255)
                            : cubemap::shines(layer, is_solo) ? IM_COL32(240, 240, 240, 210)
                                                              : IM_COL32(150, 150, 150, 120);
        draw_line(state, place, rim, IM_COL32(0, 0, 0, 150), chosen ? 5.0f : 3.5f);
        draw_line(state, place, rim, color, chosen ? 2.5f : 1.5f);
        const ImVec2 size = ImGui::CalcTextSize(layer.name.c_str());
        ImVec2 at = im(state.lat_long.pixel_of(place, middle(region)));
        at = {std::round(at.x - 0.5f * size.x), std::round(at.y - 0.5f * size.y)};
        list.AddRectFilled({at.x - 4, at.y - 1}, {at.x + size.x + 4, at.y + size.y + 1},
                           IM_COL32(0, 0, 0, 170), 3.0f);
        list.AddText(at, color, layer.name.c_str());
    }
}

/// Draws the current outline, closed.
void draw_lasso(const ViewState& state, const PixelRectangle& place) {
    std::vector<glm::dvec3> line(state.hand.lasso().begin(), state.hand.lasso().end());
    if (line.size() < 2)
        return;
    line.push_back(line.front());
    draw_line(state, place, line, IM_COL32(0, 0, 0, 150), 4.0f);
    draw_line(state, place, line, IM_COL32(255, 190, 60, 255), 2.0f);
}

void end_lasso(ViewState& state) {
    try {
        const bool added = state.hand.end_lasso(state.lasso);
        state.message = added ? "" : "a lasso needs an outline: drag around what is to change";
        state.message_is_error = !added;
        if (added)
            state.tool = Tool::Move; // to move, resize or change it next
    } catch (const std::invalid_argument& error) {
        state.message = error.what();
        state.message_is_error = true;
    }
    state.heat_is_stale = true;
}

void point_and_drag(ViewState& state, const PixelRectangle& place) {
    const ImGuiIO& io = ImGui::GetIO();
    const glm::dvec2 pixel(io.MousePos.x, io.MousePos.y);
    const std::optional<glm::dvec3> direction = state.lat_long.direction(place, pixel);
    const bool hovered = ImGui::IsItemHovered();
    if (hovered && io.MouseWheel != 0.0f)
        state.lat_long.zoom_at(place, pixel, io.MouseWheel);

    const double tolerance = RimReach * 360.0 / (state.lat_long.zoom * std::max(place.width, 1));
    const bool moves_layers = state.tool == Tool::Move && !state.hand.is_dragging();
    const Held held =
        hovered && direction && moves_layers ? held_at(state.desk, *direction, tolerance) : Held{};
    if (held.grip != Grip::None)
        ImGui::SetMouseCursor(held.grip == Grip::Body ? ImGuiMouseCursor_Hand
                                                      : ImGuiMouseCursor_ResizeAll);
    if (hovered && direction && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
        if (state.tool == Tool::Paint)
            state.hand.begin_stroke(state.brush, *direction);
        else if (state.tool == Tool::Lasso)
            state.hand.begin_lasso(*direction);
        else if (held.grip != Grip::None)
            state.hand.begin_drag(held, *direction);
        else
            state.desk.select(std::nullopt);
    }
    if (!ImGui::IsItemActive())
        return;
    const bool has_moved = io.MouseDelta.x != 0.0f || io.MouseDelta.y != 0.0f;
    if (!has_moved)
        return;
    if (!state.hand.is_dragging() && !state.hand.is_painting() && state.hand.lasso().empty())
        state.lat_long.pan(place, {io.MouseDelta.x, io.MouseDelta.y});
    else if (direction)
        state.hand.move_to(*direction, 0.4 * tolerance);
}

} // namespace

void environment_panel(ViewState& state, const PanelLayout& layout) {
    begin_panel("environment tools", layout.environment_tools);
    picture_tools(state);
    edit_tools(state);
    ImGui::End();

    begin_panel("environment", layout.environment, true);
    ImGui::InvisibleButton("environment picture", ImGui::GetContentRegionAvail(),
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                               ImGuiButtonFlags_MouseButtonMiddle);
    point_and_drag(state, layout.environment);
    if (ImGui::IsMouseReleased(ImGuiMouseButton_Left) &&
        (state.hand.is_dragging() || state.hand.is_painting())) {
        state.hand.end();
        state.heat_is_stale = true;
    }
    if (ImGui::IsMouseReleased(ImGuiMouseButton_Left) && !state.hand.lasso().empty())
        end_lasso(state);
    draw_layers(state, layout.environment);
    draw_lasso(state, layout.environment);
    ImGui::End();
}

} // namespace relumine::viewer
