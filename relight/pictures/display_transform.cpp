#include "relight/pictures/display_transform.h"

#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#ifdef RELUMINE_OCIO
#include <OpenColorIO/OpenColorIO.h>

#include "files/joined.h"
#include "files/nearest_name.h"
#endif

namespace relumine::relight {

#ifndef RELUMINE_OCIO

struct DisplayTransform::Impl {};

DisplayTransform::DisplayTransform(const DisplayView& view) {
    throw std::runtime_error(fmt::format(
        "{}: this build has no OpenColorIO (packages/ocio.txt, -DRELUMINE_OCIO=ON)", view.config));
}
void DisplayTransform::apply(std::span<glm::vec3>) const {}

#else

namespace ocio = OCIO_NAMESPACE;

namespace {

/// What configs call the linear colours of Rec. 709; the last is the role that every config has.
constexpr const char* LinearSpaces[] = {"Linear Rec.709 (sRGB)",
                                        "lin_rec709",
                                        "Utility - Linear - sRGB",
                                        "Utility - Linear - Rec.709",
                                        "lin_srgb",
                                        "Linear",
                                        "scene_linear"};

/// Returns the wanted name, or the config's own for an empty one. Refuses others than `known`.
std::string chosen(const DisplayView& view, const char* what, const std::string& wanted,
                   const char* own, const std::vector<std::string>& known) {
    if (wanted.empty())
        return own;
    for (const std::string& name : known)
        if (name == wanted)
            return name;
    throw std::runtime_error(fmt::format("{}: expected a {} among {}, got '{}'{}", view.config,
                                         what, files::joined(known, ", "), wanted,
                                         files::did_you_mean(wanted, known)));
}

} // namespace

struct DisplayTransform::Impl {
    ocio::ConstCPUProcessorRcPtr processor;
};

DisplayTransform::DisplayTransform(const DisplayView& view) {
    try {
        const auto config = ocio::Config::CreateFromFile(view.config.c_str());
        std::vector<std::string> names;
        for (int i = 0; i < config->getNumDisplays(); ++i)
            names.emplace_back(config->getDisplay(i));
        const std::string display =
            chosen(view, "display", view.display, config->getDefaultDisplay(), names);
        names.clear();
        for (int i = 0; i < config->getNumViews(display.c_str()); ++i)
            names.emplace_back(config->getView(display.c_str(), i));
        const std::string name =
            chosen(view, "view", view.view, config->getDefaultView(display.c_str()), names);
        const auto transform = ocio::DisplayViewTransform::Create();
        transform->setDisplay(display.c_str());
        transform->setView(name.c_str());
        for (const char* space : LinearSpaces)
            if (config->getColorSpace(space)) {
                transform->setSrc(space);
                break;
            }
        impl_ = std::make_unique<const Impl>(
            Impl{config->getProcessor(transform)->getDefaultCPUProcessor()});
    } catch (const ocio::Exception& error) {
        std::string reason = error.what();
        reason.resize(std::min(reason.size(), reason.find('\n')));
        throw std::runtime_error(fmt::format("{}: {}", view.config, reason));
    }
}

void DisplayTransform::apply(std::span<glm::vec3> pixels) const {
    ocio::PackedImageDesc image(pixels.data(), static_cast<long>(pixels.size()), 1, 3);
    impl_->processor->apply(image);
}

#endif

DisplayTransform::~DisplayTransform() = default;

} // namespace relumine::relight
