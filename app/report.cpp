#include "app/report.h"

#include <utility>

#include <nlohmann/json.hpp>

namespace relumine::app {

using nlohmann::json;

Report::Report() : json_(std::make_unique<json>(json::object())) {}

Report::Report(std::initializer_list<Field> fields) : Report() {
    for (const Field& field : fields)
        (*json_)[std::string(field.name)] = *field.value.json_;
}

Report::Report(std::nullptr_t) : json_(std::make_unique<json>()) {}
Report::Report(bool value) : json_(std::make_unique<json>(value)) {}
Report::Report(double value) : json_(std::make_unique<json>(value)) {}
Report::Report(const char* text) : json_(std::make_unique<json>(text)) {}
Report::Report(std::string_view text) : json_(std::make_unique<json>(text)) {}
Report::Report(Signed value) : json_(std::make_unique<json>(value.value)) {}
Report::Report(Unsigned value) : json_(std::make_unique<json>(value.value)) {}
Report::Report(const glm::dvec3& vector)
    : json_(std::make_unique<json>(json::array({vector.x, vector.y, vector.z}))) {}
Report::Report(const std::vector<double>& numbers) : json_(std::make_unique<json>(numbers)) {}
Report::Report(const std::vector<std::string>& texts) : json_(std::make_unique<json>(texts)) {}

Report::Report(const std::vector<Report>& values) : json_(std::make_unique<json>(json::array())) {
    for (const Report& value : values)
        json_->push_back(*value.json_);
}

Report::~Report() = default;
Report::Report(const Report& other) : json_(std::make_unique<json>(*other.json_)) {}
Report::Report(Report&& other) noexcept = default;
Report& Report::operator=(Report&& other) noexcept = default;

Report& Report::operator=(const Report& other) {
    return *this = Report(other);
}

void Report::set(const std::string& name, const Report& value) {
    (*json_)[name] = *value.json_;
}

void Report::update(const Report& other) {
    json_->update(*other.json_);
}

bool Report::empty() const {
    return json_->empty();
}

std::string Report::text() const {
    return json_->dump(2, ' ', false, json::error_handler_t::replace);
}

std::string Report::line() const {
    return json_->dump(-1, ' ', false, json::error_handler_t::replace);
}

} // namespace relumine::app
