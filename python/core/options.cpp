#include "options.h"

#include <algorithm>
#include <string>
#include <vector>

#include "files/nearest_name.h"

namespace relumine::python {

namespace {

/// The text of a value as the command line has it.
std::string text_of(const OptionRow& option, const py::handle& value) {
    if (value.is_none())
        return "";
    if (py::isinstance<py::str>(value))
        return value.cast<std::string>();
    if (py::isinstance<py::bool_>(value))
        return value.cast<bool>() ? "true" : "false";
    if (PySequence_Check(value.ptr()) != 0 && PyObject_Length(value.ptr()) >= 0) {
        std::string text;
        const py::object values = py::reinterpret_borrow<py::object>(value);
        bool is_first = true;
        for (const py::handle each : values) {
            text += (is_first ? "" : ",") + text_of(option, each);
            is_first = false;
        }
        return text;
    }
    PyErr_Clear(); // of arrays without a dimension, which are numbers
    if (PyIndex_Check(value.ptr()) != 0)
        return py::str(py::int_(py::reinterpret_borrow<py::object>(value)));
    if (PyNumber_Check(value.ptr()) != 0)
        return py::repr(
            py::float_(value.cast<double>())); // numpy's own numbers have a repr of theirs
    throw OptionError(option.long_name(), "expected text, a number or a list of numbers, got " +
                                              py::repr(value).cast<std::string>());
}

void set(const OptionRow& option, const py::handle& value) {
    if (option.bare && py::isinstance<py::bool_>(value)) {
        if (value.cast<bool>())
            option.set("");
        return;
    }
    // Text, a number, or numbers that are one value.
    const auto is_one = [](const py::handle& given) {
        return py::isinstance<py::str>(given) || PyNumber_Check(given.ptr()) != 0;
    };
    const bool is_color = option.type == "TEXT" && py::isinstance<py::sequence>(value) &&
                          !is_one(value) && py::len(value) != 0 &&
                          PyNumber_Check(py::object(value[py::int_(0)]).ptr()) != 0;
    if (!option.repeats || is_one(value) || is_color)
        return option.set(text_of(option, value));
    std::vector<std::string> texts;
    for (const py::handle each : value)
        texts.push_back(text_of(option, each));
    if (!texts.empty())
        option.set(texts);
}

py::object default_of(const OptionRow& option) {
    if (option.is_flag)
        return py::bool_(option.initial == "true");
    if (option.initial.empty())
        return py::none();
    if (const auto sides = parse_sides(option.initial))
        return py::make_tuple(sides->first, sides->second);
    const auto number = parse_number(option.initial);
    if (!number)
        return py::str(option.initial);
    return option.type == "UINT" ? py::object(py::int_(static_cast<long long>(*number)))
                                 : py::object(py::float_(*number));
}

} // namespace

void take(const OptionTable& table, const py::dict& given) {
    for (const auto& [key, value] : given) {
        const auto name = key.cast<std::string>();
        const auto row = std::find_if(table.begin(), table.end(),
                                      [&](const OptionRow& each) { return each.key() == name; });
        if (row == table.end()) {
            std::vector<std::string> names;
            for (const OptionRow& each : table)
                names.push_back(each.key());
            throw py::type_error("no option " + name + files::did_you_mean(name, names));
        }
        if (value.is_none())
            continue;
        for (const OptionRow& other : table)
            if (other.long_name() == row->excludes && given.contains(other.key()) &&
                !given[other.key().c_str()].is_none())
                throw OptionError(row->long_name(),
                                  "expected either it or " + row->excludes + ", got both");
        set(*row, value);
    }
}

void bind_options(py::module_& module) {
    module.def("picture_options", [] {
        OutputOptions options;
        py::list rows;
        for (const OptionRow& each : options_of(options))
            rows.append(py::make_tuple(each.key(), default_of(each), each.help,
                                       !each.example.empty() ? py::object(py::str(each.example))
                                       : !each.choices.empty()
                                           ? py::object(py::str(each.choices.back()))
                                           : default_of(each)));
        return rows;
    });
}

} // namespace relumine::python
