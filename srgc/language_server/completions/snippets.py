"""What is offered as a whole where an item or a statement may begin."""

from __future__ import annotations

from types import MappingProxyType

ITEMS = MappingProxyType(
    {
        "module": "module ${1:L} {\n  role ${2|link,joint,base,effector|};\n  $0\n}",
        "edge": "edge ${1:eps};",
        "include": 'include "${1:modules.srg}";',
        "grammar": ("grammar ${1:Arm} {\n  start ${2:N};\n  ${3:base}: ${2:N} -> ${4:B};\n  $0\n}"),
        "semantics": "semantics ${1:Arm} {\n  ${2:base} { this.frame = world; }\n  $0\n}",
        "workspace": (
            "workspace ${1:Bench} {\n  plane xy;\n  bounds box [${2:0, 5}] x [${3:0, 5}] m;\n"
            "  region ${4:S} box [${5:0, 1}] x [${6:0, 1}] m;\n"
            "  target ${7:T} box [${8:2, 3}] x [${9:2, 3}] m;\n  $0\n}"
        ),
        "task": (
            "task ${1:Reach} {\n  robot ${2:Arm};\n  workspace ${3:Bench};\n"
            "  start in ${4:S} at rest;\n  reach ${5:T};\n  effort <= ${6:10} N*m;\n"
            "  horizon ${7:40} steps of ${8:0.1} s;\n  $0\n}"
        ),
    }
)

STATEMENTS = MappingProxyType(
    {
        "module": {
            "param": "param ${1:length} in [${2:0.5}, ${3:5}] ${4:m};",
            "const": "const ${1:density} = ${2:1} ${3:kg/m};",
            "dof": "dof ${1:q}: ${2|revolute,prismatic|} ${3:z} in [${4:-180}, ${5:180}] ${6:deg};",
            "state": "state ${1:current} ${2:A} = ${3:0};",
            "input": "input ${1:voltage} in [${2:-24}, ${3:24}] ${4:V};",
            "der": "der(${1:current}) = $0;",
            "torque": "torque(${1:q}) = ${0:u};",
        },
        "grammar": {
            "production": "${1:label}: ${2:N} -> ${3:N eps L};",
            "accept": "accept ${0:contains EN};",
        },
        "semantics": {},
        "workspace": {
            "region": "region ${1:S} box [${2:0, 1}] x [${3:0, 1}] ${4:m};",
            "obstacle": "obstacle ${1:O} box [${2:0, 1}] x [${3:0, 1}] ${4:m};",
            "target": "target ${1:T} box [${2:0, 1}] x [${3:0, 1}] ${4:m};",
            "obstacles": 'obstacles from "${1:map.yaml}";',
        },
        "task": {
            "start": "start in ${1:S} at rest;",
            "reach": "reach ${1:T};",
            "avoid": "avoid ${1:O} with ${2|effector,body|};",
            "effort": "effort <= ${1:10} ${2|N*m,N|};",
            "horizon": "horizon ${1:40} steps of ${2:0.1} s;",
            "satisfy": "satisfy ${0:eventually T};",
        },
    }
)

EMISSIONS = MappingProxyType(
    {
        "rod": (
            "rod(frame: ${1:N.frame}, axis: ${2:x}, length: ${3:L.length}, "
            "density: ${4:L.density});"
        ),
        "point": "point(frame: ${1:this.frame}, mass: ${2:1 kg});",
        "solid": (
            "solid(frame: ${1:this.frame}, mass: ${2:1 kg}, com: ${3:(0, 0) m}, "
            "inertia: ${4:0.1 kg*m^2});"
        ),
        "effector": "effector(frame: ${1:this.frame});",
    }
)
