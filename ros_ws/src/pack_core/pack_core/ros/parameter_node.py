"""Base of the nodes whose parameters are the fields of a configuration class."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from pack_core.errors import ConfigError, PackError
from pack_core.ros.params import ParameterSet, unknown


class ParameterNode(Node):
    """A node that refuses what its configuration refuses, with the reason, and keeps what it takes.

    Attributes:
        parameter_set: the configuration that `read_parameters` has read, if it has.
    """

    parameter_set: ParameterSet[Any] | None = None

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Put new values of parameters in force, all or none; what is refused is refused with the reason."""
        try:
            for parameter in parameter_list:
                if not self.has_parameter(parameter.name):
                    raise ConfigError(f"no parameter {unknown(self, parameter.name)}")
            if self.parameter_set is None:
                raise ConfigError(f"node '{self.get_name()}' reads its parameters only when it starts")
            stored, when = self.parameter_set.change(parameter_list)
        except PackError as error:
            return SetParametersResult(successful=False, reason=str(error))
        result = super().set_parameters_atomically(stored)
        if result.successful:
            result.reason = f"counts {when}"
            self.get_logger().info(", ".join(f"{item.name} is {item.value}" for item in stored) + f", {when}")
        return result
