#include <filesystem>
#include <utility>

#include <imgui.h>

#include "viewer/panels.h"

namespace relumine::viewer {

void drop_dialogue(ViewState& state) {
    constexpr const char* Title = "What is this picture to be?";
    constexpr float ButtonWidth = 150.0f;
    if (state.dropped.empty())
        return;
    if (!ImGui::IsPopupOpen(Title))
        ImGui::OpenPopup(Title);
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {16.0f, 12.0f});
    ImGui::SetNextWindowPos({0.5f * display.x, 0.5f * display.y}, ImGuiCond_Always, {0.5f, 0.5f});
    const bool seen =
        ImGui::BeginPopupModal(Title, nullptr,
                               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoSavedSettings);
    ImGui::PopStyleVar();
    if (!seen)
        return;
    ImGui::TextUnformatted(state.dropped.filename().string().c_str());
    ImGui::Dummy({0.0f, 6.0f});
    const bool environment = ImGui::Button("The environment", {ButtonWidth, 0.0f});
    ImGui::SameLine();
    const bool layer = ImGui::Button("An image layer", {ButtonWidth, 0.0f});
    ImGui::SameLine();
    const bool neither =
        ImGui::Button("Cancel", {90.0f, 0.0f}) || ImGui::IsKeyPressed(ImGuiKey_Escape);
    if (environment || layer || neither) {
        const std::filesystem::path path = std::exchange(state.dropped, {});
        if (environment)
            open(state, path);
        else if (layer)
            add_image(state, path);
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
}

} // namespace relumine::viewer
