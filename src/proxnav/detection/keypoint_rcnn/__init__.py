"""The seed study's network: torchvision's Keypoint R-CNN, trained from scratch."""
