#include "viewer/window.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "files/pixel_values.h"

namespace relumine::viewer {

namespace {

/// GLFW's last error, in its own words.
std::string& last_error() {
    static std::string text;
    return text;
}

void set_style() {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 0.0f;
    style.WindowBorderSize = 0.0f;
    style.FrameRounding = 4.0f;
    style.GrabRounding = 3.0f;
    style.GrabMinSize = 8.0f;
    style.ChildRounding = 4.0f;
    style.ItemSpacing = {8.0f, 5.0f};
    style.FramePadding = {7.0f, 3.0f};
    const ImVec4 accent(0.80f, 0.55f, 0.16f, 1.0f);
    const auto faint = [&](float alpha) {
        return ImVec4(accent.x, accent.y, accent.z, alpha);
    };
    const std::array<std::pair<int, ImVec4>, 18> colors = {
        {{ImGuiCol_WindowBg, {0.12f, 0.12f, 0.13f, 1.0f}},
         {ImGuiCol_ChildBg, {0.09f, 0.09f, 0.10f, 1.0f}},
         {ImGuiCol_FrameBg, {0.21f, 0.21f, 0.23f, 1.0f}},
         {ImGuiCol_FrameBgHovered, {0.27f, 0.27f, 0.29f, 1.0f}},
         {ImGuiCol_FrameBgActive, {0.31f, 0.31f, 0.33f, 1.0f}},
         {ImGuiCol_Button, {0.25f, 0.25f, 0.28f, 1.0f}},
         {ImGuiCol_ButtonHovered, faint(0.55f)},
         {ImGuiCol_ButtonActive, faint(0.8f)},
         {ImGuiCol_Header, faint(0.35f)},
         {ImGuiCol_HeaderHovered, faint(0.5f)},
         {ImGuiCol_HeaderActive, faint(0.65f)},
         {ImGuiCol_SliderGrab, faint(0.5f)},
         {ImGuiCol_SliderGrabActive, faint(0.75f)},
         {ImGuiCol_PopupBg, {0.14f, 0.14f, 0.15f, 1.0f}},
         {ImGuiCol_TitleBgActive, {0.36f, 0.25f, 0.09f, 1.0f}},
         {ImGuiCol_ModalWindowDimBg, {0.0f, 0.0f, 0.0f, 0.55f}},
         {ImGuiCol_CheckMark, accent},
         {ImGuiCol_TextDisabled, {0.58f, 0.58f, 0.60f, 1.0f}}}};
    for (const auto& [index, color] : colors)
        style.Colors[index] = color;
}

/// Loads a font that most Linux systems have; Dear ImGui's own small one where none is found.
void load_font(float scale) {
    constexpr std::array Candidates = {
        "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf",
        "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
        "/usr/share/fonts/noto/NotoSans-Regular.ttf"};
    ImGuiIO& io = ImGui::GetIO();
    for (const char* path : Candidates)
        if (std::filesystem::exists(path) &&
            io.Fonts->AddFontFromFileTTF(path, std::round(14.0f * scale)))
            return;
    io.Fonts->AddFontDefault();
}

float linear(std::uint8_t encoded) {
    return files::linear_of_srgb(static_cast<float>(encoded) / 255.0f);
}

} // namespace

struct Window::Impl {
    GLFWwindow* window = nullptr;
    bool scripted = false;
    std::vector<std::filesystem::path> dropped;
    std::vector<Shortcut> shortcuts;

    [[nodiscard]] bool flies() const {
        return !scripted && glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
    }

    /// Goes by the letter on the key, not by its place: Z is elsewhere on a German keyboard.
    void on_key(int key, int scancode, int modifiers) {
        if (ImGui::GetIO().WantTextInput || flies())
            return;
        const char* key_name = glfwGetKeyName(key, scancode);
        const std::string_view letter = key_name ? key_name : "";
        const bool control = (modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_SUPER)) != 0;
        const bool shift = (modifiers & GLFW_MOD_SHIFT) != 0;
        if (control && letter == "z")
            shortcuts.push_back(shift ? Shortcut::Redo : Shortcut::Undo);
        else if (control && letter == "y")
            shortcuts.push_back(Shortcut::Redo);
        else if (key == GLFW_KEY_DELETE)
            shortcuts.push_back(Shortcut::Delete);
        else if (!control && letter == "f")
            shortcuts.push_back(Shortcut::FrameAll);
        else if (!control && letter == "w")
            shortcuts.push_back(Shortcut::Wireframe);
        else if (!control && letter == "q")
            shortcuts.push_back(Shortcut::Quadtree);
        else if (!control && letter == "p")
            shortcuts.push_back(Shortcut::SavePicture);
    }
};

Window::Window(int width, int height, const std::string& title, bool scripted)
    : impl_(std::make_unique<Impl>()) {
    impl_->scripted = scripted;
    glfwSetErrorCallback([](int, const char* text) { last_error() = text; });
#ifdef GLFW_PLATFORM
    // GLFW 3.4 asks Wayland first, whose library complains on stderr where there is none.
    const char* wayland = std::getenv("WAYLAND_DISPLAY");
    if (wayland == nullptr || *wayland == '\0')
        glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
    if (glfwInit() == GLFW_FALSE)
        throw std::runtime_error("cannot open a window (`relight` draws without one): " +
                                 last_error());
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_RESIZABLE, scripted ? GLFW_FALSE : GLFW_TRUE);
    impl_->window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (!impl_->window) {
        glfwTerminate();
        throw std::runtime_error("cannot open a window with OpenGL 3.3: " + last_error());
    }
    glfwMakeContextCurrent(impl_->window);
    glfwSwapInterval(scripted ? 0 : 1);
    glEnable(GL_MULTISAMPLE);

    // Set before Dear ImGui's callbacks, which call these in turn.
    glfwSetWindowUserPointer(impl_->window, impl_.get());
    glfwSetDropCallback(impl_->window, [](GLFWwindow* window, int count, const char** paths) {
        static_cast<Impl*>(glfwGetWindowUserPointer(window))->dropped.assign(paths, paths + count);
    });
    glfwSetKeyCallback(impl_->window, [](GLFWwindow* window, int key, int scancode, int action,
                                         int modifiers) {
        if (action != GLFW_RELEASE)
            static_cast<Impl*>(glfwGetWindowUserPointer(window))->on_key(key, scancode, modifiers);
    });

    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr; // leaves nothing behind in the current folder
    float scale = 1.0f;
    if (!scripted)
        glfwGetWindowContentScale(impl_->window, &scale, nullptr);
    set_style();
    load_font(scale);
    ImGui_ImplGlfw_InitForOpenGL(impl_->window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(impl_->window);
    glfwTerminate();
}

bool Window::should_close() const {
    return glfwWindowShouldClose(impl_->window) != 0;
}

PanelLayout Window::layout() const {
    int width = 1;
    int height = 1;
    glfwGetWindowSize(impl_->window, &width, &height);
    return panel_layout(width, height);
}

void Window::begin_frame(double wait_seconds, const std::optional<Pointer>& pointer) {
    if (wait_seconds > 0.0)
        glfwWaitEventsTimeout(wait_seconds);
    else
        glfwPollEvents();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    if (impl_->scripted) {
        ImGuiIO& io = ImGui::GetIO();
#if IMGUI_VERSION_NUM >= 18700
        // Behind what the real pointer did, and all in this frame.
        io.ConfigInputTrickleEventQueue = false;
        io.AddMousePosEvent(pointer ? pointer->pixel.x : -1.0f, pointer ? pointer->pixel.y : -1.0f);
        io.AddMouseButtonEvent(0, pointer && pointer->down);
        io.AddMouseButtonEvent(1, false);
        io.AddMouseButtonEvent(2, false);
#else
        io.MousePos = pointer ? ImVec2(pointer->pixel.x, pointer->pixel.y) : ImVec2(-1.0f, -1.0f);
        io.MouseDown[0] = pointer && pointer->down;
        io.MouseDown[1] = io.MouseDown[2] = false;
#endif
    }
    ImGui::NewFrame();
    int width = 0;
    int height = 0;
    glfwGetFramebufferSize(impl_->window, &width, &height);
    glViewport(0, 0, width, height);
    glDisable(GL_SCISSOR_TEST);
    glClearColor(0.04f, 0.04f, 0.045f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

PixelRectangle Window::in_framebuffer(const PixelRectangle& part) const {
    int width = 0;
    int height = 0;
    int buffer_width = 0;
    int buffer_height = 0;
    glfwGetWindowSize(impl_->window, &width, &height);
    glfwGetFramebufferSize(impl_->window, &buffer_width, &buffer_height);
    if (width < 1 || height < 1)
        return {};
    const auto scaled = [](int value, int to, int from) {
        return static_cast<int>(std::lround(static_cast<double>(value) * to / from));
    };
    return {.x = scaled(part.x, buffer_width, width),
            .y = buffer_height - scaled(part.y + part.height, buffer_height, height),
            .width = scaled(part.width, buffer_width, width),
            .height = scaled(part.height, buffer_height, height)};
}

void Window::set_viewport(const PixelRectangle& part) const {
    const PixelRectangle place = in_framebuffer(part);
    glViewport(place.x, place.y, place.width, place.height);
}

void Window::end_frame() {
    ImGui::Render();
    int width = 0;
    int height = 0;
    glfwGetFramebufferSize(impl_->window, &width, &height);
    glViewport(0, 0, width, height);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

relight::Picture Window::screenshot() const {
    int width = 0;
    int height = 0;
    glfwGetFramebufferSize(impl_->window, &width, &height);
    relight::Picture picture{.width = static_cast<std::uint32_t>(width),
                             .height = static_cast<std::uint32_t>(height)};
    std::vector<std::uint8_t> bytes(std::size_t{picture.width} * picture.height * 3);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, bytes.data());
    picture.pixels.reserve(bytes.size() / 3);
    for (std::size_t y = picture.height; y-- > 0;) // OpenGL's first row is the lowest
        for (std::size_t x = 0; x < picture.width; ++x) {
            const std::uint8_t* pixel = &bytes[3 * (y * picture.width + x)];
            picture.pixels.emplace_back(linear(pixel[0]), linear(pixel[1]), linear(pixel[2]));
        }
    return picture;
}

void Window::show() {
    glfwSwapBuffers(impl_->window);
}

std::vector<std::filesystem::path> Window::take_dropped_files() {
    return std::exchange(impl_->dropped, {});
}

std::vector<Shortcut> Window::take_shortcuts() {
    return std::exchange(impl_->shortcuts, {});
}

glm::vec3 Window::steering() const {
    if (!impl_->flies() || ImGui::GetIO().WantTextInput)
        return glm::vec3(0.0f);
    // By the keys' places, which are those of W, A, S and D on an American keyboard.
    const auto axis = [&](int more, int less) {
        const auto is_down = [&](int key) {
            return glfwGetKey(impl_->window, key) == GLFW_PRESS ? 1.0f : 0.0f;
        };
        return is_down(more) - is_down(less);
    };
    const glm::vec3 direction(axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q),
                              axis(GLFW_KEY_W, GLFW_KEY_S));
    return direction * (ImGui::GetIO().KeyShift ? 4.0f : 1.0f);
}

std::string Window::renderer() const {
    const auto* text = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    return text ? text : "unknown";
}

} // namespace relumine::viewer
