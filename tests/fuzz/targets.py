"""The readers of everything that comes from outside, each with sound files to begin with."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fuzz import readers, samples
from fuzz.samples import Sample

ITEMS = "article,length,width,height,weight,quantity\na,0.4,0.3,0.2,5,3\nb,0.3,0.2,0.15,2.5,2\n"
TAGS = "tags: {red: 0, blue_block: 1, c: 2}\n"
BOXES = "- {name: a-1, size: [0.3, 0.2, 0.2], mass: 4.0}\n- {name: b-2, size: [0.3, 0.2, 0.2], mass: 2.5}\n"


@dataclass(frozen=True)
class Target:
    """A reader.

    Attributes:
        name: what it reads.
        kind: "yaml", "json" or "binary"; decides how its files are mutated.
        samples: makes the sound files; given an empty folder to work in.
        read: reads a file that is in place; raises PackError for one that must not be used.
    """

    name: str
    kind: str
    samples: Callable[[Path], Sequence[Sample]]
    read: Callable[[Path], Any]


TARGETS = (
    Target("scene", "yaml", samples.scenes, readers.scene),
    Target("order", "json", samples.shipped("orders/*.json"), readers.order),
    Target("blocks problem", "yaml", samples.problems, readers.problem),
    Target("run.yaml", "yaml", samples.records, readers.record),
    Target("node parameters", "yaml", samples.shipped("nodes/*/*.yaml"), readers.nodes),
    Target("cells", "yaml", samples.shipped("cells/*.yaml"), readers.cells),
    Target("weights", "yaml", samples.shipped("weights/*.yaml"), readers.weights),
    Target("motion", "yaml", samples.shipped("motion/*.yaml"), readers.motion),
    Target("packing list", "yaml", samples.shipped("packing_lists/*.yaml"), readers.packing_list),
    Target("object set", "yaml", samples.shipped("object_sets/*.yaml"), readers.object_set),
    Target("mesh", "binary", samples.meshes, readers.mesh),
    Target("visitors", "yaml", samples.shipped("visitors/*.yaml"), readers.visitors),
    Target("list of boxes", "binary", samples.one(ITEMS, "items.csv"), readers.items),
    Target("presets", "yaml", samples.shipped("presets/packing/*.yaml"), readers.presets),
    Target("graphs", "yaml", samples.shipped("graphs/*.yaml"), readers.graphs),
    Target("trials", "binary", samples.trials, readers.trial),
    Target("bag file", "binary", samples.bags, readers.bag),
    Target("metadata of a bag", "yaml", samples.bag_folders, readers.bag),
    Target("saved run", "binary", samples.saved_runs, readers.saved_run),
    Target("uploaded scene", "yaml", samples.sent_scenes, readers.upload),
    Target("message: cell", "yaml", samples.sent_scenes, readers.described),
    Target("message: tags", "yaml", samples.one(TAGS, "tags.yaml"), readers.tags),
    Target("message: boxes", "yaml", samples.one(BOXES, "boxes.yaml"), readers.boxes),
)
"""All readers."""
