#include "app/command_line/man_page.h"
#include "files/joined.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

namespace relumine::app {

namespace {

/// Text of one line as roff shows it literally.
std::string literal(std::string_view text) {
    std::string result;
    for (const char c : text)
        if (c == '\\')
            result += "\\e";
        else if (c == '-')
            result += "\\-";
        else if (c == '\n')
            result += ' ';
        else
            result += c;
    // A point or an apostrophe at the beginning would be a request.
    return result.starts_with('.') || result.starts_with('\'') ? "\\&" + result : result;
}

std::string bold(std::string_view text) {
    return fmt::format("\\fB{}\\fR", literal(text));
}

std::string italic(std::string_view text) {
    return fmt::format("\\fI{}\\fR", literal(text));
}

/// Lines as they are, with their spaces.
std::string verbatim(const std::string& text) {
    std::string result = ".nf\n";
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (line.empty() && result == ".nf\n")
            continue; // an empty line at the beginning
        else
            result += literal(line) + '\n';
    return result + ".fi\n";
}

/// A description is a phrase; here it is a sentence.
std::string sentence(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' '))
        text.pop_back();
    if (!text.empty() && text.back() != '.')
        text += '.';
    return text;
}

std::string synopsis(const CommandTable& command, const std::string& words) {
    std::string result = bold(words);
    if (!command.commands.empty())
        return result + " " + italic("COMMAND") + "\n";
    result += " [" + italic("OPTION") + "]...";
    for (const OptionRow& option : command.options)
        if (option.is_argument()) {
            const std::string name = italic(option.name) + (option.repeats ? "..." : "");
            result += option.required ? " " + name : " [" + name + "]";
        }
    return result + "\n";
}

/// A paragraph with the option's names and value as its tag.
std::string paragraph(const OptionRow& option) {
    std::string tag;
    if (option.is_argument()) {
        tag = italic(option.name);
    } else {
        for (const std::string& name : option.names())
            tag += (tag.empty() ? "" : ", ") + bold(name);
        if (!option.is_flag) {
            const std::string value = italic(option.type);
            tag += " " + value;
        }
    }
    std::string text = sentence(option.help);
    if (!option.choices.empty())
        text += fmt::format(" One of: {}.", files::joined(option.choices, ", "));
    if (!option.range().empty())
        text += fmt::format(" From {}.", option.range());
    if (!option.shown_default().empty())
        text += fmt::format(" Default: {}.", option.shown_default());
    if (option.required && !option.is_argument())
        text += " Required.";
    return fmt::format(".TP\n{}\n{}\n", tag, literal(text));
}

std::string paragraphs(const std::string& title, const CommandTable& command, bool arguments) {
    std::string result;
    for (const OptionRow& option : command.options)
        if (option.is_argument() == arguments)
            result += paragraph(option);
    return result.empty() ? result : fmt::format(".SH {}\n{}", title, result);
}

/// Pages of a command and of those below it. `page` is its page's name, `parent` the page above.
void add_pages(const CommandTable& command, const std::string& page, const std::string& words,
               const std::string& parent, std::string_view version, std::vector<ManPage>& pages) {
    std::string upper = page;
    std::transform(upper.begin(), upper.end(), upper.begin(),
                   [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
    const std::string phrase = command.description.substr(0, command.description.find(". "));
    std::string text = fmt::format(".TH {} 1 \"\" \"relumine {}\" \"Relumine manual\"\n",
                                   literal(upper), literal(version));
    text += fmt::format(".SH NAME\n{} \\- {}\n", literal(page), literal(phrase));
    text += ".SH SYNOPSIS\n" + synopsis(command, words);
    text += paragraphs("ARGUMENTS", command, true);
    text += paragraphs("OPTIONS", command, false);
    std::string see_also = parent.empty() ? "" : fmt::format(".BR {} (1)", literal(parent));
    if (!command.commands.empty()) {
        text += ".SH COMMANDS\n";
        for (const CommandTable& below : command.commands) {
            text += fmt::format(".TP\n{}\n{}\n", bold(below.name),
                                literal(sentence(below.description)));
            see_also += fmt::format("{}.BR {} (1)", see_also.empty() ? "" : ",\n",
                                    literal(page + "-" + below.name));
        }
    }
    if (!command.footer.empty())
        text += ".SH NOTES\n" + verbatim(command.footer);
    text += ".SH EXIT STATUS\n0: done, 1: the work failed, 2: wrong usage.\n";
    text += ".SH SEE ALSO\n" + see_also + "\n";
    pages.push_back({.name = page, .text = text});
    for (const CommandTable& below : command.commands)
        add_pages(below, page + "-" + below.name, words + " " + below.name, page, version, pages);
}

} // namespace

std::vector<ManPage> man_pages(const CommandTable& program, std::string_view version) {
    std::vector<ManPage> pages;
    add_pages(program, program.name, program.name, "", version, pages);
    return pages;
}

} // namespace relumine::app
