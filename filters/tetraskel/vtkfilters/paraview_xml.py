"""A filter's ParaView panel, written from its options: one XML block, so that order, words and tooltips are ours."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import fields
from xml.sax.saxutils import escape, quoteattr

from tetraskel.vtkfilters.base import camel_case
from tetraskel.vtkfilters.paraview_display import display_hints

ONLY_FOR = {  # kinds of input that `when` names
    "image": 'type="InputDataTypeDecorator" mode="visibility" name="vtkImageData"',
    "points": 'type="InputDataTypeDecorator" mode="visibility" name="vtkImageData" exclude="1"',
}
ALSO_OPTIONS = ("Engine", "Spacing")  # facts with the name of an option, from which scripts must tell them
MENU = '<ShowInMenu category="Skeleton Tree"/>'


def panel_xml(cls) -> str:
    """Documentation, inputs and properties of a filter class, for `smproperty.xml`."""
    first = _input("Input", 0, cls.input_type, cls.input_doc, "")
    second = _input(*cls.second_input, hints="<Hints><Optional/></Hints>") if cls.second_input else ""
    properties = "\n".join(_property(declared, cls.options) for declared in fields(cls.options))
    found = "\n".join(_fact(name, doc) for name, doc in cls.tells.items())
    groups = "".join(_group(title, map(camel_case, names)) for title, names in cls.options.groups.items())
    groups += _group("Found", [f"Found{name}" for name in cls.tells])
    ports = "".join(f'<OutputPort name="{name}" index="{k}"/>' for k, name in enumerate(cls.output_names))
    return "\n".join([_documentation(cls), first, second, properties, found, groups, ports])


def hints_xml(cls) -> str:
    """Where a filter is in the menu, and how its outputs are drawn, for `smhint.xml`."""
    return MENU + display_hints(cls)


def label(name: str) -> str:
    """`FlatTetraRemoval` is shown as "Flat Tetra Removal"; without the spaces it is the name in scripts."""
    return "".join(" " + letter if letter.isupper() else letter for letter in name).strip()


def page_of(cls) -> str:
    """A filter's page, in the source; ParaView's own help shows pages of compiled plugins only."""
    return f"docs/filters/{label(cls.__name__).lower().replace(' ', '_')}.md"


def _documentation(cls) -> str:
    text = " ".join(cls.__doc__.replace("`", "").split())
    first = text.split(". ")[0].rstrip(".") + "."
    text += f" With a picture in the source: {page_of(cls)}."
    return f"<Documentation short_help={quoteattr(first)} long_help={quoteattr(first)}>{escape(text)}</Documentation>"


def _input(name: str, port: int, data_type: str, doc: str, hints: str) -> str:
    return (
        f'<InputProperty name="{name}" command="SetInputConnection" port_index="{port}">'
        f'<DataTypeDomain name="input_type"><DataType value="{data_type}"/></DataTypeDomain>'
        f"<Documentation>{escape(doc)}</Documentation>{hints}</InputProperty>"
    )


def _property(declared, options) -> str:
    name, metadata = camel_case(declared.name), declared.metadata
    unit = f" Unit: {metadata['unit']}." if metadata["unit"] else ""
    n = len(declared.default) if isinstance(declared.default, tuple) else 1
    common = f'name="{name}" command="Set{name}" number_of_elements="{n}" default_values="{_default(declared)}"'
    kind = _kind(declared)
    documentation = f"<Documentation>{escape(metadata['doc'] + unit)}</Documentation>"
    return f"<{kind} {common}>{_domain(declared)}{documentation}{_shown_when(declared, options)}</{kind}>"


def _fact(name: str, doc: str) -> str:
    """A read-only field."""
    shown = label(name) + (" Used" if name in ALSO_OPTIONS else "")
    common = f'name="Found{name}" label="{shown}" command="GetFound{name}" number_of_elements="1"'
    kind = 'information_only="1" panel_visibility="default"'
    return f"<StringVectorProperty {common} {kind}><Documentation>{escape(doc)}</Documentation></StringVectorProperty>"


def _group(title: str, names: Iterable[str]) -> str:
    members = "".join(f'<Property name="{name}"/>' for name in names)
    return f'<PropertyGroup label="{title}">{members}</PropertyGroup>' if members else ""


def _kind(declared) -> str:
    if declared.metadata["choices"] or isinstance(declared.default, int):
        return "IntVectorProperty"
    return "StringVectorProperty" if isinstance(declared.default, str) else "DoubleVectorProperty"


def _shown_when(declared, options) -> str:
    """Hide an option that does not apply to the chosen word of another one."""
    if not declared.metadata["when"]:
        return ""
    name, word = declared.metadata["when"]
    if name == "Input":
        return f"<Hints><PropertyWidgetDecorator {ONLY_FOR[word]}/></Hints>"
    (other,) = (field for field in fields(options) if field.name == name)
    value = other.metadata["choices"].index(word) if other.metadata["choices"] else word
    decorator = f'type="GenericDecorator" mode="visibility" property="{camel_case(name)}" value="{value}"'
    return f"<Hints><PropertyWidgetDecorator {decorator}/></Hints>"


def _default(declared) -> str:
    if declared.metadata["choices"]:
        return str(declared.metadata["choices"].index(declared.default))
    if isinstance(declared.default, tuple):
        return " ".join(map(str, declared.default))
    return str(int(declared.default)) if isinstance(declared.default, bool) else str(declared.default)


def _domain(declared) -> str:
    metadata = declared.metadata
    if metadata["choices"]:
        entries = "".join(
            f'<Entry value="{k}" text={quoteattr(word.capitalize())}/>' for k, word in enumerate(metadata["choices"])
        )
        return f'<EnumerationDomain name="enum">{entries}</EnumerationDomain>'
    if isinstance(declared.default, bool):
        return '<BooleanDomain name="bool"/>'
    if metadata["bounds"] is None:
        return ""
    kind = "DoubleRangeDomain" if isinstance(declared.default, float) else "IntRangeDomain"
    low, high = metadata["slider"]
    upper = f' max="{high}"' if math.isfinite(high) else ""
    return f'<{kind} name="range" min="{low}"{upper}/>'
