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
    ImGui::SetNextWindowPos({0.5f * display.x, 0.5f * display.y}, ImGuiCond_Always, {0.5f, 0.5f});
    if (!ImGui::BeginPopupModal(Title, nullptr,
                                ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoSavedSettings))
        return;
    ImGui::TextUnformatted(state.dropped.filename().string().c_str());
    ImGui::Spacing();
    const bool environment = ImGui::Button("The environment", {ButtonWidth, 0.0f});
    ImGui::SameLine();
    const bool layer = ImGui::Button("An image layer", {ButtonWidth, 0.0f});
    ImGui::SameLine();
    const bool neither = ImGui::Button("Cancel") || ImGui::IsKeyPressed(ImGuiKey_Escape);
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
