"""Kinematics of serial arms, in no robot's particular convention."""
