#include "viewer/panel_layout.h"

#include <algorithm>

namespace relumine::viewer {

PanelLayout panel_layout(int width, int height) {
    constexpr int ToolsHeight = 40, RowHeight = 25;
    constexpr int EnvironmentToolsHeight = 72; // two rows
    constexpr int StatusHeight = 30;
    constexpr int Gap = 2;
    const int body = std::max(height - StatusHeight - Gap, 1);
    const int right_width = std::clamp(width * 46 / 100, 1, 900);
    const int left_width = std::max(width - right_width - Gap, 1);
    const int right_x = left_width + Gap;
    // The scene's tools take so many rows, with the button of its lamps.
    const int scene_tools_height = ToolsHeight + (left_width < 440   ? 2
                                                  : left_width < 820 ? 1
                                                                     : 0) *
                                                     RowHeight;
    const int environment_height =
        std::max(std::min(right_width / 2, body - EnvironmentToolsHeight), 1);
    const int layers_y = EnvironmentToolsHeight + environment_height + Gap;
    return {.scene_tools = {.x = 0, .y = 0, .width = left_width, .height = scene_tools_height},
            .scene = {.x = 0,
                      .y = scene_tools_height,
                      .width = left_width,
                      .height = std::max(body - scene_tools_height, 1)},
            .environment_tools = {.x = right_x,
                                  .y = 0,
                                  .width = right_width,
                                  .height = EnvironmentToolsHeight},
            .environment = {.x = right_x,
                            .y = EnvironmentToolsHeight,
                            .width = right_width,
                            .height = environment_height},
            .layers = {.x = right_x,
                       .y = layers_y,
                       .width = right_width,
                       .height = std::max(body - layers_y, 1)},
            .status = {.x = 0, .y = body + Gap, .width = width, .height = StatusHeight}};
}

} // namespace relumine::viewer
