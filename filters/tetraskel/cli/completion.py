"""Print a script that lets the shell complete commands, options, their values and file names.

It is made from the commands as they are, so it cannot know others; print it again after an update.
"""

from __future__ import annotations

import argparse

from tetraskel.cli.usage import commands_of

SHELLS = ("bash", "zsh", "fish")
EXAMPLES = (
    ("For bash, in ~/.bashrc:", 'completion bash   # eval "$(tetraskel completion bash)"'),
    ("For zsh, in ~/.zshrc, behind compinit:", 'completion zsh    # eval "$(tetraskel completion zsh)"'),
    ("For fish, in ~/.config/fish/config.fish:", "completion fish   # tetraskel completion fish | source"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel completion` takes."""
    parser.add_argument("shell", metavar="SHELL", choices=SHELLS, help=", ".join(SHELLS))


def run(chosen: argparse.Namespace) -> None:
    """Print the script."""
    print({"bash": bash, "zsh": zsh, "fish": fish}[chosen.shell](), end="")


def commands() -> dict[str, argparse.ArgumentParser]:
    """Every command with its parser."""
    from tetraskel.cli import parser

    return commands_of(parser())


def options(command: argparse.ArgumentParser) -> list[argparse.Action]:
    """The options of a command."""
    return [action for action in command._actions if action.option_strings]


def places(command: argparse.ArgumentParser) -> list[str]:
    """The words a command takes in a place, where they are words and no files."""
    return [str(word) for action in command._actions if not action.option_strings for word in action.choices or ()]


def bash() -> str:
    """A function of bash 3.2 or later; where it knows no words, bash offers files."""
    cases = []
    for name, command in commands().items():
        for action in options(command):
            if action.choices:
                flags = "|".join(f'"{name} {flag}"' for flag in action.option_strings)
                cases.append(f'        {flags}) words="{" ".join(action.choices)}" ;;')
        flags = [flag for action in options(command) for flag in action.option_strings]
        cases.append(f'        "{name} "*) [[ $word == -* ]] && words="{" ".join(flags)}" || words="{_in(command)}" ;;')
    return f"""# Completion of tetraskel for bash: eval "$(tetraskel completion bash)"
_tetraskel() {{
    local word="${{COMP_WORDS[COMP_CWORD]}}" words=""
    case "${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD-1]}}" in
        *" tetraskel") words="{" ".join(commands())} --help --version" ;;
{chr(10).join(cases)}
    esac
    COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o bashdefault -o default -F _tetraskel tetraskel
"""


def _in(command: argparse.ArgumentParser) -> str:
    return " ".join(places(command))


def zsh() -> str:
    """A function for zsh's completion system, with the meaning of each option."""
    cases = []
    for name, command in commands().items():
        words = places(command)
        rest = f"'*:word:({' '.join(words)})'" if words else "'*:file:_files'"
        lines = [
            f"            {_zsh_option(flag, action)} \\" for action in options(command) for flag in _shown(action)
        ]
        cases.append("\n".join([f"        {name}) _arguments -S \\", *lines, f"            {rest} ;;"]))
    told = "\n".join(f"            {_quoted(name + ':' + _summary(command))}" for name, command in commands().items())
    return f"""#compdef tetraskel
# Completion of tetraskel for zsh, behind compinit: eval "$(tetraskel completion zsh)"
_tetraskel() {{
    if (( CURRENT == 2 )); then
        local -a told=(
{told}
        )
        _describe command told
        return
    fi
    shift words
    (( CURRENT -= 1 ))
    case $words[1] in
{chr(10).join(cases)}
    esac
}}
compdef _tetraskel tetraskel
"""


def _zsh_option(flag: str, action: argparse.Action) -> str:
    meaning = "".join(" " if mark in "[]:\\" else mark for mark in _meaning(action))
    what = ""
    if action.choices:
        what = f":value:({' '.join(action.choices)})"
    elif action.nargs != 0:
        optional, files = action.nargs == "?", action.metavar == "FILE"
        what = f":{(action.metavar or 'value').lower()}:{'_files' if files else ''}"
        what = f":{what}" if optional else what * int(action.nargs or 1)
    return _quoted(f"{flag}[{meaning}]{what}")


def fish() -> str:
    """One `complete` for each command and option."""
    lines = ["# Completion of tetraskel for fish: tetraskel completion fish | source"]
    for name, command in commands().items():
        about = _quoted(_summary(command))
        lines.append(f"complete -c tetraskel -n __fish_use_subcommand -f -a {name} -d {about}")
        seen = f"complete -c tetraskel -n '__fish_seen_subcommand_from {name}'"
        if places(command):
            lines.append(f"{seen} -f -a '{_in(command)}'")
        for action in options(command):
            flags = " ".join(f"-l {flag[2:]}" if flag.startswith("--") else f"-s {flag[1:]}" for flag in _shown(action))
            lines.append(f"{seen} {flags}{_fish_value(action)} -d {_quoted(_meaning(action))}")
    return "\n".join(lines) + "\n"


def _fish_value(action: argparse.Action) -> str:
    if action.choices:
        return f" -x -a '{' '.join(action.choices)}'"
    if action.nargs in (0, "?"):
        return ""
    return " -r -F" if action.metavar == "FILE" else " -x"


def _shown(action: argparse.Action) -> list[str]:
    return list(action.option_strings)


def _summary(command: argparse.ArgumentParser) -> str:
    return str(command.description).splitlines()[0].rstrip(".")


def _meaning(action: argparse.Action) -> str:
    """The first sentence of an option's help."""
    return str(action.help).replace("%%", "%").split(". ")[0].rstrip(".")


def _quoted(text: str) -> str:
    """In single quotes, as all three shells take it."""
    return "'" + text.replace("\\", "").replace("'", "") + "'"
