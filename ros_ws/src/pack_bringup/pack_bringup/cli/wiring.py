"""`pack wiring`: what flows where, as rows for a terminal and as the page docs/reference/dataflow.md."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from pack_bringup.cli.terminal import show_table

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract

COLUMNS = ("name", "kind", "type", "from", "to", "rate", "QoS", "recorded", "what")

PAGE = """# Data flow

Written by `pack wiring --markdown` from the wiring tables, `pack_core/ros/contracts/`.
[conventions.md](../concepts/conventions.md) has frames, units and clocks.

## All cells

What every cell has in the same way. The pictures and tables below leave it out. `all` stands for every node,
`user` for whoever looks on or sends goals.

{shared}
"""

SECTION = """
## {cell}

```mermaid
flowchart LR
{edges}
```

{table}
"""


def wiring_rows(contracts: Iterable[Contract]) -> Iterator[tuple[str, ...]]:
    """One row of `COLUMNS` for each contract."""
    for contract in contracts:
        yield (
            contract.name,
            contract.kind.value,
            _type_name(contract.type, contract.kind.value),
            ", ".join(contract.sources),
            ", ".join(contract.targets),
            contract.rate,
            _qos_text(contract),
            "yes" if contract.recorded else "",
            contract.what,
        )


def wiring_page(tables: Mapping[str, Sequence[Contract]]) -> str:
    """The text of docs/reference/dataflow.md, from the contracts by cell."""
    rows = [dict.fromkeys(wiring_rows(contracts)) for contracts in tables.values()]
    shared = [row for row in rows[0] if all(row in others for others in rows)]
    names = {row[0] for row in shared}
    own = {cell: [item for item in table if item.name not in names] for cell, table in tables.items()}
    return PAGE.format(shared=_table(shared)) + "".join(_section(cell, table) for cell, table in own.items())


def _section(cell: str, contracts: Sequence[Contract]) -> str:
    return SECTION.format(
        cell=cell.capitalize(), edges="\n".join(_edges(contracts)), table=_table(wiring_rows(contracts))
    )


def _table(rows: Iterable[tuple[str, ...]]) -> str:
    lines = [COLUMNS, tuple("---" for _ in COLUMNS), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def _edges(contracts: Sequence[Contract]) -> Iterator[str]:
    """Arrows between named nodes; what goes to or comes from everyone would only hide them."""
    pairs: dict[tuple[str, str], list[str]] = {}
    for contract in contracts:
        if len(contract.sources) < 3 and "all" not in contract.targets:
            for pair in ((source, target) for source in contract.sources for target in contract.targets):
                pairs.setdefault(pair, []).append(contract.name)
    for (source, target), names in pairs.items():
        if target != "recorder":
            yield f'    {source} -->|"{"<br>".join(names)}"| {target}'


def _type_name(message: type, kind: str) -> str:
    package = message.__module__.split(".")[0]
    return f"{package}/{ {'topic': 'msg', 'service': 'srv', 'action': 'action'}[kind] }/{message.__name__}"


def _qos_text(contract: Contract) -> str:
    if contract.qos is None:
        return ""
    words = [contract.qos.reliability.name.lower(), f"depth {contract.qos.depth}"]
    if contract.is_latched:
        words.append("latched")
    return ", ".join(words)


app = typer.Typer()


@app.command()
def wiring(
    cell: Annotated[str, typer.Argument(help="Cell whose wiring is shown.")] = "packing",
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Write all cells as the page docs/reference/dataflow.md.")
    ] = False,
) -> None:
    """List every topic, service and action of a cell, with who sends and who takes it.

    - `pack wiring packing`
    - `pack wiring --markdown > docs/reference/dataflow.md`
    """
    from pack_core.ros.contracts.table import wiring_of, wiring_tables

    if markdown:
        typer.echo(wiring_page(wiring_tables()), nl=False)
        return
    show_table(COLUMNS, list(wiring_rows(wiring_of(cell))))
