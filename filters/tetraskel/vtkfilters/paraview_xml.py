"""A filter's ParaView panel, written from its options: one XML block, so that order, words and tooltips are ours."""

from __future__ import annotations

from dataclasses import fields
from xml.sax.saxutils import escape, quoteattr

from tetraskel.vtkfilters.base import camel_case

MENU = '<ShowInMenu category="Skeleton Tree"/>'


def panel_xml(cls) -> str:
    """Documentation, inputs and properties of a filter class, for `smproperty.xml`."""
    properties = "\n".join(_property(declared) for declared in fields(cls.options))
    return f"{_documentation(cls)}\n{_input(cls)}\n{properties}"


def label(name: str) -> str:
    """`FlatTetraRemoval` is shown as "Flat Tetra Removal"; without the spaces it is the name in scripts."""
    return "".join(" " + letter if letter.isupper() else letter for letter in name).strip()


def _documentation(cls) -> str:
    text = " ".join(cls.__doc__.replace("`", "").split())
    first = text.split(". ")[0].rstrip(".") + "."
    return f"<Documentation short_help={quoteattr(first)} long_help={quoteattr(first)}>{escape(text)}</Documentation>"


def _input(cls) -> str:
    return (
        '<InputProperty name="Input" command="SetInputConnection">'
        f'<DataTypeDomain name="input_type"><DataType value="{cls.input_type}"/></DataTypeDomain>'
        f"<Documentation>{escape(cls.input_doc)}</Documentation></InputProperty>"
    )


def _property(declared) -> str:
    name, metadata = camel_case(declared.name), declared.metadata
    unit = f" Unit: {metadata['unit']}." if metadata["unit"] else ""
    common = f'name="{name}" command="Set{name}" number_of_elements="1" default_values="{_default(declared)}"'
    level = ' panel_visibility="advanced"' if metadata["advanced"] else ""
    kind = "DoubleVectorProperty" if isinstance(declared.default, float) else "IntVectorProperty"
    documentation = f"<Documentation>{escape(metadata['doc'] + unit)}</Documentation>"
    return f"<{kind} {common}{level}>{_domain(declared)}{documentation}</{kind}>"


def _default(declared) -> str:
    if declared.metadata["choices"]:
        return str(declared.metadata["choices"].index(declared.default))
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
    low, high = metadata["bounds"]
    return f'<{kind} name="range" min="{low}" max="{high}"/>'
