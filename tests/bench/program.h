// What all benches share: options on the command line, and how a bench begins and ends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace relumine::bench {

/// Data that a bench needs and that is not there: it says so and has not failed.
struct Absent : std::runtime_error {
    /// "no NAME; set RELUMINE_DATA to the folder that holds it"
    explicit Absent(const std::filesystem::path& name);
};

/// A bench as a program: "--name VALUE" options, "--name" flags, --help and --tiny.
class Program {
public:
    Program(std::string name, std::string description);

    /// Options; the variable's value is the default. They must outlive run().
    void add(const std::string& option, std::string& value, const std::string& help = "");
    void add(const std::string& option, std::filesystem::path& value, const std::string& help = "");
    void add(const std::string& option, std::uint32_t& value, const std::string& help = "");
    void add(const std::string& option, std::size_t& value, const std::string& help = "");
    void add(const std::string& option, int& value, const std::string& help = "");
    void add(const std::string& option, float& value, const std::string& help = "");
    void add(const std::string& option, double& value, const std::string& help = "");
    /// Several values with commas between them; words are some of the default's, if it has any
    void add(const std::string& option, std::vector<float>& values, const std::string& help = "");
    void add(const std::string& option, std::vector<std::string>& values,
             const std::string& help = "");
    void add_flag(const std::string& option, bool& value, const std::string& help = "");

    /// Small input and few repetitions: seconds, no real data. Known once run() calls the work.
    [[nodiscard]] bool is_tiny() const { return tiny_; }

    /// Reads the options and does the work. Returns the program's exit code: 0 done or data absent,
    /// 1 failed, 2 wrong usage.
    [[nodiscard]] int run(int argc, char** argv, const std::function<void()>& work);

private:
    struct Option {
        std::string name = {};
        std::string help = {};
        std::string default_value = {};
        bool is_flag = false;
        /// False for a text that is no such value
        std::function<bool(const std::string&)> read = {};
    };
    template<typename Number>
    void add_number(const std::string& option, Number& value, const std::string& help);
    void print_help() const;
    void parse(int argc, char** argv);

    std::string name_;
    std::string description_;
    std::vector<Option> options_;
    bool tiny_ = false;
    bool help_ = false;
};

} // namespace relumine::bench
